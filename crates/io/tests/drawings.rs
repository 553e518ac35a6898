//! Plots and pictures of given data.

use std::path::PathBuf;

use powerhouse_io::{
    AnimationFile, ColourMap, Deformation, FacetField, IoError, Picture, PictureField, PictureView,
    Plot, SectionPlane, TableColumn, write_picture, write_plot,
};
use powerhouse_model::{ElementKind, Mesh, Vec3};

fn folder(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("powerhouse-draw-{}-{name}", std::process::id()))
}

fn cube() -> Mesh {
    Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(2.0), [2, 2, 2], "rock").unwrap()
}

/// Width, height and pixels of a PNG.
fn decoded(file: &PathBuf) -> (usize, usize, Vec<[u8; 3]>) {
    let content = std::io::BufReader::new(std::fs::File::open(file).unwrap());
    let mut reader = png::Decoder::new(content).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    let pixels = bytes.chunks(3).map(|p| [p[0], p[1], p[2]]).collect();
    (info.width as usize, info.height as usize, pixels)
}

/// Seen from the front, without edges and shades of other faces: the colour in the middle.
fn middle(picture: &Picture, name: &str) -> [u8; 3] {
    let folder = folder(name);
    let file = folder.join("one.png");
    write_picture(&file, picture).unwrap();
    let (width, height, pixels) = decoded(&file);
    std::fs::remove_dir_all(folder).unwrap();
    assert_eq!(
        (width, height),
        (picture.width as usize, picture.height as usize)
    );
    // The body is left of the colour scale.
    pixels[height * 11 / 20 * width + (width - 150) * 11 / 20]
}

/// The pixels of a picture.
fn pixels(picture: &Picture, name: &str) -> (usize, Vec<[u8; 3]>) {
    let folder = folder(name);
    let file = folder.join("one.png");
    write_picture(&file, picture).unwrap();
    let (width, _, pixels) = decoded(&file);
    std::fs::remove_dir_all(folder).unwrap();
    (width, pixels)
}

/// Colours along a line through the middle of the picture, without those of edges of facets.
fn colours(picture: &Picture, name: &str) -> Vec<[u8; 3]> {
    let (width, pixels) = pixels(picture, name);
    let row = &pixels[picture.height as usize * 11 / 20 * width..][..width - 150];
    let drawn: Vec<[u8; 3]> = row.iter().copied().filter(|p| *p != [255; 3]).collect();
    // Where two facets meet the finer pixels of both are averaged.
    let mean = |k: &usize| drawn[*k - 1] != drawn[*k] && drawn[*k] != drawn[*k + 1];
    let inner = (2..drawn.len() - 2).filter(|k| !mean(k));
    inner.map(|k| drawn[k]).collect()
}

/// The colours beside the names of a picture, from the top.
fn beside(picture: &Picture, name: &str) -> Vec<[u8; 3]> {
    let (width, pixels) = pixels(picture, name);
    let rows = pixels.chunks(width).map(|row| row[width - 150 + 8 + 2]);
    // Letters and their edges are grey.
    let plain = |colour: &[u8; 3]| colour.iter().any(|part| part.abs_diff(colour[0]) > 8);
    let mut colours: Vec<[u8; 3]> = rows.filter(plain).collect();
    colours.dedup();
    colours
}

fn from_front<'a>(mesh: &'a Mesh, field: PictureField<'a>) -> Picture<'a> {
    let mut picture = Picture::new(mesh, field, "v (m/s)");
    picture.view = PictureView::along(Vec3::y());
    picture.edges = false;
    picture.colours = ColourMap::Grey;
    (picture.width, picture.height) = (330, 200);
    picture
}

/// A section shows only the elements behind it.
#[test]
fn a_section_opens_the_body() {
    let mesh = cube();
    let layer: Vec<f64> = (0..8).map(|e| mesh.centroid(e).y.floor()).collect();
    let mut picture = from_front(&mesh, PictureField::Elemental(&layer));
    picture.range = Some([0.0, 1.0]);
    let whole = middle(&picture, "whole");
    picture.section = Some(SectionPlane {
        point: Vec3::new(0.0, 1.0, 0.0),
        normal: -Vec3::y(),
    });
    let cut = middle(&picture, "cut");
    // The dark end in front, the light end behind, under the same light.
    assert!(whole[0] < 45 && cut[0] > 150, "{whole:?} {cut:?}");
    assert!((f64::from(whole[0]) / f64::from(cut[0]) - 40.0 / 235.0).abs() < 0.02);
    picture.section = Some(SectionPlane {
        point: Vec3::repeat(-1.0),
        normal: Vec3::x(),
    });
    let error = write_picture("never.png".as_ref(), &picture).unwrap_err();
    assert!(matches!(error, IoError::NothingToDraw { .. }), "{error}");
}

/// A slice of one layer that is cut open in its middle is drawn whole, whatever its centroids round to.
#[test]
fn a_slice_cut_in_its_middle_is_drawn_whole() {
    for start in [0.1, 0.3, 0.7, 1.1, 2.3, -5.1] {
        let (low, high) = (Vec3::new(0.0, start, 0.0), Vec3::new(2.0, start + 0.1, 2.0));
        let mesh = Mesh::box_of_hexes(low, high, [3, 1, 3], "rock").unwrap();
        let layer = vec![1.0; mesh.element_count()];
        let mut picture = from_front(&mesh, PictureField::Elemental(&layer));
        let whole = pixels(&picture, "slice");
        picture.section = Some(SectionPlane {
            point: (low + high) / 2.0,
            normal: -3.0 * Vec3::y(),
        });
        assert!(pixels(&picture, "slice-cut") == whole, "{start}");
    }
}

/// Numbers at nodes are interpolated, and the colours range from the least to the greatest visible number.
#[test]
fn nodal_numbers_are_interpolated() {
    let mesh = cube();
    let along: Vec<f64> = mesh.positions().iter().map(|p| 3.0 + p.x).collect();
    let picture = from_front(&mesh, PictureField::Nodal(&along));
    let folder = folder("nodal");
    let file = folder.join("one.png");
    write_picture(&file, &picture).unwrap();
    let (width, height, pixels) = decoded(&file);
    std::fs::remove_dir_all(folder).unwrap();
    let row = &pixels[height / 2 * width..][..width - 150];
    let body: Vec<u8> = row
        .iter()
        .filter(|p| **p != [255; 3])
        .map(|p| p[0])
        .collect();
    assert!(body.len() > 100);
    assert!(
        body.windows(2).all(|pair| pair[0] <= pair[1] + 1),
        "{body:?}"
    );
    let (first, last) = (f64::from(body[2]), f64::from(body[body.len() - 3]));
    assert!((first / last - 40.0 / 235.0).abs() < 0.04, "{first} {last}");
}

/// A displacement moves the nodes by its factor.
#[test]
fn a_displacement_moves_the_body() {
    let mesh = cube();
    // Stretched to twice its width, the body fills another part of the picture.
    let stretch: Vec<Vec3> = mesh
        .positions()
        .iter()
        .map(|p| Vec3::x() * p.x * 0.1)
        .collect();
    let filled = |deformation| {
        let mut picture = from_front(&mesh, PictureField::Sets);
        picture.deformation = deformation;
        let folder = folder("moved");
        let file = folder.join("one.png");
        write_picture(&file, &picture).unwrap();
        let (width, height, pixels) = decoded(&file);
        std::fs::remove_dir_all(folder).unwrap();
        let drawn = |x: usize, y: usize| pixels[y * width + x] != [255; 3];
        let wide = (0..width - 150)
            .filter(|&x| drawn(x, height * 11 / 20))
            .count();
        let high = (0..height)
            .filter(|&y| drawn((width - 150) * 11 / 20, y))
            .count();
        wide as f64 / high as f64
    };
    let displacement = stretch.as_slice();
    let moved = filled(Some(Deformation {
        displacement,
        factor: 5.0,
    }));
    assert!((moved / filled(None) - 1.5).abs() < 0.05, "{moved}");
}

/// The pictures of an animation are those that are written one by one, in turn and each for its time; a body that moves
/// does so in the picture, since its scale is that of the stated extents.
#[test]
fn pictures_of_an_animation_are_those_of_files() {
    let folder = folder("animation");
    let mesh = cube();
    let values: Vec<f64> = mesh.positions().iter().map(|p| p.x).collect();
    let aside = vec![Vec3::x(); mesh.node_count()];
    let picture = |factor: f64| {
        let mut picture = Picture::new(&mesh, PictureField::Nodal(&values), "x (m)");
        picture.view = PictureView::along(Vec3::y());
        (picture.width, picture.height) = (300, 200);
        picture.extents = Some([Vec3::zeros(), Vec3::repeat(4.0)]);
        picture.deformation = Some(Deformation {
            displacement: &aside,
            factor,
        });
        picture
    };
    let (file, one) = (folder.join("moving.png"), folder.join("one.png"));
    let mut animation = AnimationFile::new(&file, 3, 0.04).unwrap();
    for factor in [0.0, 1.0, 2.0] {
        assert!(!file.exists());
        animation.add(&picture(factor)).unwrap();
    }
    let error = animation.add(&picture(3.0)).unwrap_err().to_string();
    assert!(error.contains("there are more than 3 pictures"), "{error}");
    let content = std::io::BufReader::new(std::fs::File::open(&file).unwrap());
    let mut reader = png::Decoder::new(content).read_info().unwrap();
    assert_eq!(reader.info().animation_control.unwrap().num_frames, 3);
    let mut lefts = Vec::new();
    for factor in [0.0, 1.0, 2.0] {
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut bytes).unwrap();
        let control = reader.info().frame_control.unwrap();
        assert_eq!(control.delay_num * 25, control.delay_den);
        write_picture(&one, &picture(factor)).unwrap();
        let (width, _, pixels) = decoded(&one);
        assert_eq!(bytes, pixels.as_flattened());
        let row = &pixels[110 * width..][..width - 150];
        lefts.push(row.iter().position(|pixel| *pixel != [255; 3]).unwrap());
    }
    // A body of 2 m in extents of 4 m moves by a quarter of their width.
    assert!(lefts[1] > lefts[0] + 10);
    assert!((lefts[2] - lefts[1]).abs_diff(lefts[1] - lefts[0]) <= 1);
    std::fs::remove_dir_all(folder).unwrap();
}

/// An animation of pictures of two sizes, of none, or with a time out of range is refused.
#[test]
fn animations_out_of_range_are_refused() {
    let mesh = cube();
    let error = |pictures, seconds| AnimationFile::new("never.png", pictures, seconds).err();
    assert!(matches!(error(0, 0.1), Some(IoError::Setting { .. })));
    assert!(matches!(error(2, f64::NAN), Some(IoError::Setting { .. })));
    let mut animation = AnimationFile::new("never.png", 2, 0.1).unwrap();
    let mut picture = Picture::new(&mesh, PictureField::Sets, "");
    animation.add(&picture).unwrap();
    picture.width = 100;
    let error = animation.add(&picture).unwrap_err().to_string();
    assert!(
        error.contains("never.png: a picture has 100 by 900 pixels"),
        "{error}"
    );
    assert!(!std::path::Path::new("never.png").exists());
}

/// Two squares side by side in the plane y = 1, the left one with 0 at its corners, the right one
/// with 2.
fn squares() -> FacetField {
    let corner = |x: f64, z: f64| Vec3::new(x, 1.0, z);
    let square = |x: f64| {
        let ends = [(x, 0.0), (x + 1.0, 0.0), (x + 1.0, 2.0), (x, 2.0)];
        ends.map(|(x, z)| corner(x, z))
    };
    FacetField {
        positions: [square(0.0), square(1.0)].concat(),
        facets: vec![vec![0, 1, 2, 3], vec![4, 5, 6, 7]],
        values: [[0.0; 4], [2.0; 4]].concat(),
    }
}

/// Separate facets are drawn instead of the body, with the numbers of their own corners; a
/// section removes those in front of it, and invalid ones are refused.
#[test]
fn facets_are_drawn_instead_of_the_body() {
    let mesh = cube();
    let field = squares();
    let mut picture = from_front(&mesh, PictureField::Facets(&field));
    picture.range = Some([0.0, 2.0]);
    let seen = colours(&picture, "facets");
    // Dark at the left, light at the right, and nothing of the body.
    let [first, last] = [seen[0], seen[seen.len() - 1]];
    assert!(first[0] < 45 && last[0] > 225, "{first:?} {last:?}");
    assert!(seen.iter().all(|c| *c == first || *c == last), "{seen:?}");
    picture.section = Some(SectionPlane {
        point: Vec3::new(1.0, 0.0, 0.0),
        normal: Vec3::x(),
    });
    let left = colours(&picture, "facets-cut");
    assert!(left.iter().all(|c| *c == first), "{left:?}");

    let wrong = FacetField {
        facets: vec![vec![0, 1, 8]],
        ..squares()
    };
    let picture = from_front(&mesh, PictureField::Facets(&wrong));
    let error = write_picture("never.png".as_ref(), &picture).unwrap_err();
    assert!(
        matches!(
            error,
            IoError::Facet {
                facet: 0,
                corners: 8,
                ..
            }
        ),
        "{error}"
    );
    let short = FacetField {
        values: vec![0.0; 7],
        ..squares()
    };
    let picture = from_front(&mesh, PictureField::Facets(&short));
    let error = write_picture("never.png".as_ref(), &picture).unwrap_err();
    assert!(matches!(error, IoError::Length { .. }), "{error}");
}

/// Categories have one colour each, without others between them, in a legend with their
/// names instead of a scale.
#[test]
fn kinds_have_a_colour_each() {
    let mesh = cube();
    let mut field = squares();
    // From one kind to another within the right square.
    field.values = vec![0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 2.0, 0.0];
    let mut picture = from_front(&mesh, PictureField::Facets(&field));
    let smooth = colours(&picture, "kinds-smooth");
    assert!(smooth.len() > 20);
    picture.names = &["sticks", "slides", "open"];
    let mut kinds = colours(&picture, "kinds");
    kinds.dedup();
    assert_eq!(kinds.len(), 3, "{kinds:?}");
    // The colours beside the names are those on the facets.
    let legend = beside(&picture, "kinds-legend");
    let shaded = |colour: &[u8; 3], legend: &[u8; 3]| {
        let share = |i: usize| f64::from(colour[i]) / f64::from(legend[i]);
        (share(0) - share(1)).abs() < 0.02 && (share(0) - share(2)).abs() < 0.02
    };
    assert_eq!(legend.len(), 3, "{legend:?}");
    for (colour, legend) in kinds.iter().zip(&legend) {
        assert!(shaded(colour, legend), "{kinds:?} {legend:?}");
    }
}

/// Bars are drawn too.
#[test]
fn bars_are_drawn() {
    let mut builder = Mesh::builder();
    builder.node(1, Vec3::zeros());
    builder.node(2, Vec3::new(2.0, 0.0, 1.0));
    builder.element(1, ElementKind::Bar2, &[1, 2], &["bolt"]);
    let mesh = builder.build().unwrap();
    let picture = from_front(&mesh, PictureField::Elemental(&[1.0]));
    let folder = folder("bars");
    let file = folder.join("one.png");
    write_picture(&file, &picture).unwrap();
    let (width, height, pixels) = decoded(&file);
    std::fs::remove_dir_all(folder).unwrap();
    let drawn = |x: usize| (0..height).any(|y| pixels[y * width + x] != [255; 3]);
    assert!((40..160).all(drawn));
}

/// Settings and fields that cannot be drawn are refused by name, and nothing is written.
#[test]
fn faulty_pictures_are_refused() {
    let mesh = cube();
    let file = folder("faulty").join("never.png");
    let short = Picture::new(&mesh, PictureField::Nodal(&[1.0]), "speed");
    let error = write_picture(&file, &short).unwrap_err();
    assert!(matches!(error, IoError::Length { found: 1, .. }), "{error}");
    let mut values = vec![0.0; 27];
    values[13] = f64::NAN;
    let nan = Picture::new(&mesh, PictureField::Nodal(&values), "speed");
    let message = write_picture(&file, &nan).unwrap_err().to_string();
    assert!(
        message.contains("'speed'") && message.contains("index 13"),
        "{message}"
    );
    let sound = Picture::new(&mesh, PictureField::Sets, "");
    let mut faulty = [(); 5].map(|()| sound.clone());
    faulty[0].width = 1_000_000;
    faulty[1].height = 0;
    faulty[2].view.direction = Vec3::zeros();
    faulty[3].range = Some([1.0, 0.0]);
    faulty[4].section = Some(SectionPlane {
        point: Vec3::zeros(),
        normal: Vec3::repeat(f64::NAN),
    });
    for picture in &faulty {
        let error = write_picture(&file, picture).unwrap_err();
        assert!(matches!(error, IoError::Setting { .. }), "{error}");
    }
    assert!(!file.exists());
}

fn table() -> Vec<TableColumn> {
    let times: Vec<f64> = (0..200).map(|i| 0.01 * f64::from(i)).collect();
    let of = |f: fn(f64) -> f64| times.iter().map(|&t| f(t)).collect::<Vec<_>>();
    vec![
        TableColumn::new("time", "s", times.clone()),
        TableColumn::new("a<b & \"c\"", "m", of(|t| 0.003 * t.sin())),
        TableColumn::new("floor", "m", of(|t| 0.001 * t.cos())),
        TableColumn::new("crown", "m/s", of(|t| 2.5 * t)),
    ]
}

/// A plot has a panel per unit, names every curve and unit, and is valid XML.
#[test]
fn a_plot_names_what_it_shows() {
    let folder = folder("plot");
    let file = folder.join("histories.svg");
    let table = table();
    write_plot(&file, &Plot::of_table("a run", &table)).unwrap();
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::remove_dir_all(folder).unwrap();
    for part in [
        "a&lt;b &amp; &quot;c&quot;",
        "floor",
        "crown",
        "(10⁻³ m)",
        "(m/s)",
        "time (s)",
        "prefers-color-scheme:dark",
    ] {
        assert!(text.contains(part), "{part}");
    }
    assert_eq!(text.matches("class=\"frame\"").count(), 2);
    assert_eq!(
        text.matches("<text").count(),
        text.matches("</text>").count()
    );
    assert!(!text.contains("NaN") && !text.contains("inf"));
}

/// The last point of a curve agrees with the axes.
#[test]
fn a_curve_agrees_with_the_axes() {
    let folder = folder("line");
    let file = folder.join("line.svg");
    let table = [
        TableColumn::new("x", "m", vec![0.0, 10.0]),
        TableColumn::new("y", "m", vec![0.0, 4.0]),
    ];
    write_plot(&file, &Plot::of_table("", &table)).unwrap();
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::remove_dir_all(folder).unwrap();
    let numbers = |part: &str| -> Vec<f64> {
        let part = part.replace('-', " -");
        let words = part.split([' ', 'M', 'l', 'v', 'h', '"']);
        words.filter_map(|word| word.parse().ok()).collect()
    };
    let line = |mark: &str| text.lines().rfind(|l| l.contains(mark)).unwrap();
    let curve = numbers(line("c0\" d=\"M").split("d=").nth(1).unwrap());
    // The last horizontal and vertical lines of the grid are those of 4 and 10.
    let mut grid = text.lines().filter(|l| l.starts_with("<path class=\"grid"));
    let mut vertical = grid
        .clone()
        .filter(|l| l.contains('v') && !l.contains("<text"));
    let right = numbers(vertical.next_back().unwrap().split("d=").nth(1).unwrap())[0];
    let top = grid.rfind(|l| l.contains("<text")).unwrap();
    let top = numbers(top.split("d=").nth(1).unwrap().split("/>").next().unwrap())[1];
    // From its first point by a step.
    assert_eq!(curve.len(), 4);
    let end = [curve[0] + curve[2], curve[1] + curve[3]];
    assert!(
        (end[0] - right).abs() < 0.02 && (end[1] - top).abs() < 0.02,
        "{curve:?} {right} {top}"
    );
}

/// A curve with gaps is drawn in parts, all of its points included; gaps at its ends do nothing.
#[test]
fn gaps_interrupt_a_curve() {
    let folder = folder("gaps");
    let file = folder.join("gaps.svg");
    let table = [
        TableColumn::new("x", "m", (0..6).map(f64::from).collect()),
        TableColumn::new("y", "m", vec![0.0, 4.0, 1.0, 3.0, 2.0, 4.0]),
    ];
    let drawn = |gaps: &[usize]| {
        let plot = Plot::of_table("", &table).with_gaps(gaps.to_vec());
        write_plot(&file, &plot).unwrap();
        let text = std::fs::read_to_string(&file).unwrap();
        let line = text.lines().rfind(|line| line.contains("c0\" d=\"M"));
        let path = line.unwrap().rsplit("d=").next().unwrap().to_owned();
        path.split('M')
            .skip(1)
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let whole = drawn(&[]);
    assert_eq!(whole, drawn(&[0, 6]));
    let parts = drawn(&[2, 5]);
    let steps: Vec<usize> = parts
        .iter()
        .map(|part| part.split('l').count() - 1)
        .collect();
    assert_eq!((whole.len(), &steps[..]), (1, &[1, 1, 1][..]));
    // The first part is the start of the whole curve.
    let first = parts[0].trim_end_matches(['"', '/', '>']);
    assert!(whole[0].starts_with(first), "{whole:?} {parts:?}");
    std::fs::remove_dir_all(folder).unwrap();
}

/// Curves that cannot be drawn are refused by name.
#[test]
fn faulty_plots_are_refused() {
    let file = folder("faulty-plot").join("never.svg");
    let mut nan = table();
    nan[2].values[7] = f64::INFINITY;
    let message = write_plot(&file, &Plot::of_table("", &nan))
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("'floor'") && message.contains("index 7"),
        "{message}"
    );
    let mut short = table();
    short[3].values.pop();
    let error = write_plot(&file, &Plot::of_table("", &short)).unwrap_err();
    assert!(
        matches!(error, IoError::Length { found: 199, .. }),
        "{error}"
    );
    for nothing in [&[][..], &[TableColumn::new("time", "s", vec![])][..]] {
        let error = write_plot(&file, &Plot::of_table("", nothing)).unwrap_err();
        assert!(matches!(error, IoError::NothingToDraw { .. }), "{error}");
    }
    assert!(!file.exists());
}

/// A picture shows the active elements and nothing of the others: neither their position, nor their
/// numbers, nor these in its colour scale.
#[test]
fn inactive_elements_are_not_drawn() {
    let mesh = cube();
    let present: Vec<bool> = (0..8)
        .map(|e| mesh.centroid(e).z < 1.0 || mesh.centroid(e).x < 1.0)
        .collect();
    let draw = |beyond: f64, present: Option<&[bool]>, name: &str| {
        let values: Vec<f64> = (0..8_u32)
            .map(|e| match mesh.centroid(e) {
                middle if middle.z < 1.0 || middle.x < 1.0 => f64::from(e),
                _ => beyond,
            })
            .collect();
        let mut picture = Picture::new(&mesh, PictureField::Elemental(&values), "x");
        picture.present = present;
        pixels(&picture, name)
    };
    let without = draw(0.0, Some(&present), "absent-0");
    assert!(without == draw(1e6, Some(&present), "absent-1"));
    assert!(without != draw(0.0, None, "absent-2"));
    let none = vec![false; 8];
    let mut picture = Picture::new(&mesh, PictureField::Sets, "x");
    picture.present = Some(&none);
    let file = folder("absent-3").join("x.png");
    assert!(matches!(
        write_picture(&file, &picture),
        Err(IoError::NothingToDraw { .. })
    ));
    picture.present = Some(&none[..3]);
    assert!(matches!(
        write_picture(&file, &picture),
        Err(IoError::Length { found: 3, .. })
    ));
}
