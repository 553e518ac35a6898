//! The report of a study of thirty records: what it has, and how many pages it takes.

use powerhouse_test_support::{motion_text, synthetic_motion};

use super::*;
use crate::block::Folder as Block;

/// Printable area of a page of A4 in the style of the report (mm).
const WIDTH: f64 = 180.0;
const HEIGHT: f64 = 267.0;
/// Letters in a line of text and in a row of a table, and heights of both (mm).
const LETTERS: [usize; 2] = [115, 120];
const LINES: [f64; 2] = [5.3, 5.6];

/// Reinforcement of the section of [`record_sets::SCENE`], an envelope and the set of records.
const SET: &str = r#"reinforcement = { concrete_strength = 16.7e6, bars = [1571e-6, 1571e-6], cover = 0.06, yield_stress = 435e6 }
[output.envelope]
quantities = ["displacement", "stress"]
[[record_set]]
name = "motions"
folder = "motions"
units = "m/s2"
convention = "incident"
spectrum = { target = { kind = "eurocode-8", type = 1, ground = "A", peak = 2 }, periods = [0.15, 0.6] }
[[record_set.fragility]]
name = "moved"
figure = "displacement inside [m]"
limit = 0.03
"#;

/// Bytes of base 64.
fn decoded(text: &str) -> Vec<u8> {
    let value = |letter: u8| match letter {
        b'A'..=b'Z' => u32::from(letter - b'A'),
        b'a'..=b'z' => u32::from(letter - b'a') + 26,
        b'0'..=b'9' => u32::from(letter - b'0') + 52,
        b'+' => 62,
        b'/' => 63,
        _ => 0,
    };
    let fours = text.as_bytes().chunks_exact(4);
    let bytes = fours.flat_map(|four| {
        let bits = four
            .iter()
            .fold(0, |bits, &letter| bits << 6 | value(letter));
        [bits >> 16, bits >> 8, bits].map(|byte| byte as u8)
    });
    bytes.collect()
}

/// Height over width of an embedded picture.
fn shape(image: &str) -> f64 {
    let data = |kind: &str| {
        image
            .split_once(kind)
            .map(|(_, rest)| rest.split('"').next().unwrap())
    };
    if let Some(png) = data("image/png;base64,") {
        let bytes = decoded(png);
        let number =
            |at: usize| f64::from(u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap()));
        return number(20) / number(16);
    }
    let svg =
        String::from_utf8_lossy(&decoded(data("image/svg+xml;base64,").unwrap())).into_owned();
    let frame = svg
        .split_once("viewBox=\"0 0 ")
        .unwrap()
        .1
        .split_once('"')
        .unwrap()
        .0;
    let (width, height) = frame.split_once(' ').unwrap();
    height.parse::<f64>().unwrap() / width.parse::<f64>().unwrap()
}

/// Text without markup.
fn bare(html: &str) -> String {
    let mut text = String::new();
    let mut is_text = true;
    for letter in html.chars() {
        match letter {
            '<' => is_text = false,
            '>' => is_text = true,
            letter if is_text => text.push(letter),
            _ => {}
        }
    }
    text
}

/// Height of the printed page (mm): its lines, rows of tables and figures, those of pairs beside each other.
fn printed(page: &str) -> f64 {
    let body = page.split_once("<body>").unwrap().1;
    let lines = |text: &str, of: usize| (text.chars().count().div_ceil(LETTERS[of])).max(1) as f64;
    let (mut height, mut pair) = (0.0, None::<Vec<f64>>);
    for line in body.lines() {
        if line.starts_with("<div class=\"pair\">") {
            pair = Some(Vec::new());
        } else if line.starts_with("</div>") {
            let rows = pair.take().unwrap_or_default();
            let of_row = |row: &[f64]| row.iter().copied().fold(0.0, f64::max);
            height += rows.chunks(2).map(of_row).sum::<f64>();
        } else if line.starts_with("<figure>") {
            let width = if pair.is_some() { 0.49 * WIDTH } else { WIDTH };
            let caption = lines(&bare(line), 0) * LINES[0];
            let own = width * shape(line) + caption + 8.0;
            match &mut pair {
                Some(pair) => pair.push(own),
                None => height += own,
            }
        } else if line.starts_with("<h1>") || line.starts_with("<h2") {
            height += 14.0;
        } else if line.starts_with("<p") {
            height += LINES[0] * lines(&bare(line), 0) + 4.0;
        } else if line.contains("<tr>") {
            height += LINES[1]
                * lines(
                    &bare(&line.replace("</td>", "   ").replace("</th>", "   ")),
                    1,
                );
        }
    }
    height
}

/// The page of thirty records has their spectra against the target, medians and fractiles of every result, envelopes beside what the
/// section bears, and the fragility, on ten pages at most; every case has its place in the other page and in tables.
#[test]
fn the_report_of_thirty_records_has_ten_pages_at_most() {
    let scene = record_sets::SCENE.replace("duration = 0.7", "duration = 1.4");
    let scene = scene.replace("quantities = [\"displacement\"]\n", "") + SET;
    let block = Block::new("thirty", &scene, 3);
    std::fs::create_dir_all(block.0.join("motions")).unwrap();
    for number in 1..=30 {
        let text = motion_text(&synthetic_motion(number));
        std::fs::write(block.0.join(format!("motions/r{number:02}.txt")), text).unwrap();
    }
    let sweep = Sweep::of_file(block.scene(), Some(block.out())).unwrap();
    let outcomes = sweep.run(None, &mut NoProgress).unwrap();
    let statistics = sweep.statistics().unwrap().unwrap();
    let page = std::fs::read_to_string(write_report(block.out()).unwrap()).unwrap();
    let pages = printed(&page) / HEIGHT;
    println!("{pages:.1} pages");
    assert!(pages < 10.0, "{pages}");
    // Names are in rows, as text.
    let text = bare(&page);
    for figure in &statistics.scales[0].figures {
        let [low, median, high] = figure.shown();
        assert!(
            text.contains(&format!("{}{low}{median}{high}", figure.figure)),
            "{figure:?}"
        );
    }
    for wanted in [
        "Eurocode 8",
        "Fragility curve moved",
        "N and M beside what the section bears",
        "30 of 30 cases",
        "nearest to the medians",
    ] {
        assert!(page.contains(wanted), "{wanted}");
    }
    let out = block.out();
    let of_cases = std::fs::read_to_string(out.join("report-cases.html")).unwrap();
    assert!(outcomes.iter().all(|case| of_cases.contains(&case.name)));
    assert!(printed(&of_cases) > 2.0 * printed(&page));
    let records = std::fs::read_to_string(out.join("report/records.csv")).unwrap();
    assert_eq!(records.lines().count(), 31);

    // The spectra are those of the records as the cases have them; each is the target in the mean of the band.
    let spectra = statistics.spectra.unwrap();
    let target = spectra.target.unwrap();
    assert_eq!((spectra.records.len(), target.band), (30, [0.15, 0.6]));
    let at = |period: f64| {
        spectra
            .periods
            .iter()
            .position(|own| *own >= period)
            .unwrap()
    };
    let band = at(0.15)..at(0.6);
    for record in &spectra.records {
        let ratios = band
            .clone()
            .map(|index| (record.accelerations[index] / target.accelerations[index].unwrap()).ln());
        let ratios: Vec<f64> = ratios.collect();
        let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
        assert!(mean.abs() < 0.05, "{}: {mean}", record.record);
        let csv = read_table(&out.join(format!("record-{}.csv", record.record))).unwrap();
        let peak = csv[1]
            .values
            .iter()
            .fold(0.0_f64, |most, a| most.max(a.abs()));
        assert!((record.peak / peak - 1.0).abs() < 1e-6);
    }
}
