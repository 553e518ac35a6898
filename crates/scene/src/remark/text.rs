//! Texts of remarks.

use core::fmt;

use powerhouse_model::Renewal;
use powerhouse_observe::SectionPiece;

use super::stations::{station_window, stations};
use super::{LARGE_PEAK, Remark, STANDARD_GRAVITY};
use crate::Results;

/// Number of pieces of a section that a warning describes one by one.
const SHOWN_PIECES: usize = 4;

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scene(warning) => warning.fmt(f),
            Self::Record {
                name,
                report,
                baseline,
            } => {
                write!(
                    f,
                    "record '{name}': PGA {:.3} m/s2 ({:.3} g), PGV {:.4} m/s, PGD {:.4} m; ends at {:.2e} m/s, {:.2e} m",
                    report.peak_acceleration,
                    report.peak_acceleration / STANDARD_GRAVITY,
                    report.peak_velocity,
                    report.peak_displacement,
                    report.end_velocity,
                    report.end_displacement
                )?;
                if report.peak_acceleration > LARGE_PEAK {
                    write!(
                        f,
                        ", which hardly any record has ever reached: check the unit of the record"
                    )?;
                }
                if let Some(baseline) = baseline {
                    write!(
                        f,
                        "; baseline correction {} changed it by at most {:.2e} m/s2, before it ended at {:.2e} m/s, {:.2e} m",
                        baseline.correction.name(),
                        baseline.largest_change,
                        baseline.before.end_velocity,
                        baseline.before.end_displacement
                    )?;
                    if baseline.leading_pad > 0.0 {
                        let pad = baseline.leading_pad;
                        write!(
                            f,
                            "; the filter extends it by {pad:.3} s before its original start"
                        )?;
                    }
                }
                Ok(())
            }
            Self::RecordFile { name, warning } => write!(f, "record '{name}': {warning}"),
            Self::RecordSpectrum { name, report } => write!(f, "record '{name}': {report}"),
            Self::RecordSource { name, source } => write!(f, "record '{name}': {source}"),
            Self::LargeCorrection { name, share, drift } => write!(
                f,
                "record '{name}': the baseline correction changes it by {:.0} % of its peak, and takes an end displacement of {drift:.3} m, where it is about 1 % of accelerograms: it may be a velocity or a displacement, have another time step or an offset of the instrument",
                100.0 * share
            ),
            Self::WeakRecord { name, peak, key } => {
                let shown = |value: f64| (1e4 * value).round() / 1e4;
                write!(
                    f,
                    "record '{name}': its peak of {} m/s2 (by the key `{key}`) is {:.3} g, weak for a design motion; ",
                    shown(*peak),
                    peak / STANDARD_GRAVITY
                )?;
                match *key {
                    "peak" => write!(
                        f,
                        "`peak` is in m/s2, and {} g would be {:.3}",
                        shown(*peak),
                        peak * STANDARD_GRAVITY
                    ),
                    _ => write!(f, "if the file is in g, give `units = \"g\"`"),
                }
            }
            Self::PastCritical {
                wave,
                critical,
                removed,
            } => {
                write!(
                    f,
                    "{wave} is past the critical angle of {critical:.2} degrees (asin of the speed of S waves over that of P waves): the reflected P wave travels along the surface and decays with depth, and the ground moves before the incident wave arrives"
                )?;
                match removed {
                    Some(removed) => write!(
                        f,
                        "; a taper removes the beginning of this motion, so that the body starts at rest: the input differs from the record by {:.1} % of its peak displacement",
                        100.0 * removed
                    ),
                    None => Ok(()),
                }
            }
            Self::Layered {
                wave,
                report,
                bytes,
            } => {
                let megabytes = *bytes as f64 / 1e6;
                write!(
                    f,
                    "{wave}: tables of the motion at {} heights, every {:.3e} s, and its spectra take {megabytes:.1} MB",
                    report.tables.heights, report.step
                )?;
                if let Some((heights, [displacement, velocity, stress])) =
                    report.tables.between_heights
                {
                    write!(
                        f,
                        "; they are at {heights} heights, between which cubics err by at most {displacement:.1e} of the peak displacement, {velocity:.1e} of the peak velocity and {stress:.1e} of the peak stress"
                    )?;
                }
                match report.causal {
                    true => Ok(()),
                    false => write!(
                        f,
                        "; waves decay with depth in the half-space or in a layer, and the ground moves before the incident wave arrives"
                    ),
                }
            }
            Self::EquivalentLinear {
                layers,
                strain_ratio,
                iterations,
                change,
            } => {
                write!(
                    f,
                    "equivalent linear method, {iterations} iteration(s) to {:.2} %, bulk moduli as at small strain:",
                    100.0 * change
                )?;
                for (index, layer) in layers.iter().enumerate() {
                    write!(
                        f,
                        "{} '{}' has an effective shear strain of {:.4} % ({strain_ratio} of the greatest), {:.3} of its shear modulus, held at {:.2} Hz in the run, and damping of {:.2} %; with the dispersion of that the strain is {:.4} %",
                        if index == 0 { "" } else { ";" },
                        layer.material,
                        100.0 * layer.strain,
                        layer.modulus,
                        layer.frequency,
                        100.0 * layer.damping,
                        100.0 * layer.in_run
                    )?;
                }
                Ok(())
            }
            Self::LargeStrains { materials, limit } => write!(
                f,
                "the effective shear strain of '{}' is above {} %: the equivalent linear method damps high frequencies too much there; compare with a law that yields",
                materials.join("', '"),
                100.0 * limit
            ),
            Self::PartialRing {
                ring,
                missed: [missed, of],
                angles: [from, to],
            } => write!(
                f,
                "ring '{ring}': {missed} of {of} rays meet no element, between {from} and {to} degrees from upward: there are no sections"
            ),
            Self::BeyondStrainCurves {
                material,
                strain,
                greatest,
            } => write!(
                f,
                "the effective shear strain of '{material}', {:.3} %, is beyond the last of its strain curves, {:.3} %: it has the modulus and the damping of that; a law that yields says more",
                100.0 * strain,
                100.0 * greatest
            ),
            Self::StartedFrom { origin } => write!(f, "the run {origin}"),
            Self::UnusedMaterial { name } => {
                write!(f, "material '{name}' is used by no part and no stage")
            }
            Self::Conversion {
                wave,
                convention,
                conversion,
            } => match &conversion.within {
                None => write!(
                    f,
                    "{wave}: the incident wave is {:.4} of its record ({convention})",
                    conversion.amplitude.norm()
                ),
                Some(within) => {
                    let how = match within.regularisation {
                        0.0 => "exactly".into(),
                        share => format!("with a regularisation of {share}"),
                    };
                    write!(
                        f,
                        "{wave}: the incident wave was computed from its record ({convention}) by a transfer function, {how}, with a misfit of {:.2e} of the record; its peak is {:.3} of that of the record, and the transfer function is at least {:.3} in the frequency range of the record",
                        within.misfit, within.amplification, within.least_transfer
                    )
                }
            },
            Self::Split {
                record,
                waves,
                azimuth,
                report,
                place,
                arrival,
                still,
            } => {
                let waves = waves.iter();
                let waves: Vec<String> = waves.map(|(k, a)| format!("{k} at {a:.4}")).collect();
                let [least, most] = report.band;
                write!(
                    f,
                    "record '{record}' is split into {} degrees, azimuth {azimuth:.4}: condition number at most {:.2} between {least} and {most} Hz, at {:.3} Hz; their sum is the record at ({:.3}, {:.3}, {:.3}) m, from {arrival:.3} s on, to {:.1e} of its peak acceleration, and their largest peak is {:.3} of it",
                    waves.join(", "),
                    report.condition,
                    report.frequency,
                    place.x,
                    place.y,
                    place.z,
                    report.misfit,
                    report.amplification
                )?;
                match still.is_empty() {
                    true => Ok(()),
                    false => write!(f, "; nothing moves along {}", list(still)),
                }
            }
            Self::Through {
                set,
                faces,
                share,
                contrast,
                width,
            } => write!(
                f,
                "part '{set}' runs through the absorbing faces {} ({:.2} % of their area): it absorbs there with its own impedance, {contrast:.2} times that of the ground, and takes motion and stress of the ground without it; results within {:.3} m of these faces, twice its extent there, are those of this end (stresses of a lined tunnel differed from those of a longer one by up to 26 % at half an extent, 13 % at one, 8 % at two)",
                faces.join(", "),
                100.0 * share,
                2.0 * width
            ),
            Self::QuietStart { padding, waves } => {
                write!(
                    f,
                    "all waves are delayed by {padding:.3} s so that the body starts at rest; the duration is unchanged"
                )?;
                for (wave, start) in waves {
                    write!(
                        f,
                        "; {wave} needs {:.3} s, starts with at most {:.1e} of its peak, and a taper removed {:.1e} of the peak",
                        start.padding,
                        start.level.largest(),
                        start.removed
                    )?;
                }
                Ok(())
            }
            Self::DelayedMotion {
                padding,
                records,
                waves,
            } => {
                write!(
                    f,
                    "prescribed motions are delayed by {padding:.3} s so that the body starts at rest; the duration is unchanged"
                )?;
                for (name, level) in records {
                    write!(
                        f,
                        "; record '{name}', extended by its filter, would be at {level:.1e} of its peak at the start of the run"
                    )?;
                }
                match waves {
                    Some(waves) if waves != padding => {
                        write!(
                            f,
                            "; the waves are delayed by {waves:.3} s, so that the two are no longer synchronous"
                        )
                    }
                    _ => Ok(()),
                }
            }
            Self::RotatedAxis {
                record,
                convention,
                clear,
                azimuth,
            } => write!(
                f,
                "record '{record}' has the convention '{convention}' in a wave of azimuth {azimuth} degrees: this component is along or across the direction of travel, not along an axis of the mesh; '{clear}' is the same without this warning"
            ),
            Self::AboveGround { level, top } => write!(
                f,
                "the in-situ stress of the ground is zero above its level of {level} m, and the body reaches up to {top} m"
            ),
            Self::TruncatedRecord {
                name,
                share,
                run,
                record,
            } => write!(
                f,
                "the run ends at {run:.3} s, before record '{name}' ends at {record:.3} s: only {:.1} % of its Arias intensity arrives before",
                100.0 * share
            ),
            Self::OpenSide { side, area } => write!(
                f,
                "{area:.4} m2 on the {side} of the mesh are neither absorbing nor supported: waves are reflected there"
            ),
            Self::LoadedSurface { share, position } => write!(
                f,
                "the free surface at ({:.3}, {:.3}, {:.3}) m has a free-field traction of {:.1} % of the wave stress: the free surface of the field lies elsewhere, or it has none",
                position.x,
                position.y,
                position.z,
                100.0 * share
            ),
            Self::Scatterer { position } => write!(
                f,
                "the distance of boundary springs is measured from ({:.3}, {:.3}, {:.3}) m, the centre of the parts that touch no absorbing face",
                position.x, position.y, position.z
            ),
            Self::Region { inside, layer } => write!(
                f,
                "the waves enter through {layer} elements around a region of {inside} elements; outside of them results are the scattered motion alone"
            ),
            Self::Stations {
                file,
                scale,
                axes,
                rows,
                report,
            } => stations(f, (file, *scale), (axes, rows), report),
            Self::StationWindow { file, run, report } => station_window(f, file, *run, report),
            Self::UnusedRecord { name } => {
                write!(
                    f,
                    "record '{name}' is used by no wave and no prescribed motion"
                )
            }
            Self::EmptySet { set } => write!(
                f,
                "the set '{set}' of a support, load or added mass is empty: it has no effect"
            ),
            Self::NoState { name, element } => write!(
                f,
                "history '{name}' requests the state of element {element}, whose law has no history variables"
            ),
            Self::LargeSlip { joint, share } => write!(
                f,
                "joint '{joint}' slipped or opened by {share:.2} of the shortest edge of its facets; its node pairs are fixed, which is accurate up to about {:.2}",
                Results::SMALL_SLIP
            ),
            Self::TetrahedralSection {
                section,
                set,
                elements,
                of,
            } => write!(
                f,
                "section '{section}' cuts {elements} linear tetrahedra of '{set}' ({of} elements in all): its forces are wrong, bending moments by a factor of several, since such elements are too stiff in bending; give them nodes on their edges (`order = 2` of [mesh]), or mesh '{set}' with hexahedra or wedges (finer linear tetrahedra come nearer slowly)"
            ),
            Self::HollowSection {
                section,
                set,
                filled,
                width,
                depth,
            } => write!(
                f,
                "section '{section}' of '{set}' fills {:.0} % of its {width:.3} m along and {depth:.3} m across: it cuts a frame or a ring, and its forces and moments are those of all of it; for one side give a point of it as `at`, and a `half_extent` that leaves out the others",
                100.0 * filled
            ),
            Self::SectionThroughEnd { section, set } => write!(
                f,
                "section '{section}' cuts a face at which '{set}' ends, and what acts on that face enters its forces; turn its normal so that the plane is parallel to the face, or move it away from the end",
            ),
            Self::Bending(error) => write!(f, "{error}"),
            Self::Hinge {
                section,
                set,
                kernel,
                layers,
            } => write!(
                f,
                "section '{section}' cuts '{set}', which may crack or yield, with {layers} bricks of '{kernel}' across: a point in the middle of each cracks or yields as a whole, while bending stays elastic, so that moments may exceed what the section bears; take kernel = \"hex8-eas\", or at least 4 bricks across"
            ),
            Self::BeyondCapacity {
                section,
                utilisation,
                from,
                time,
                axial,
                moment,
                borne,
            } => {
                let [axial, moment] = [axial, moment].map(|force| 1e-3 * force);
                write!(
                    f,
                    "section '{section}' is beyond what its reinforcement bears from {from:.3} s on: "
                )?;
                match borne {
                    Some([least, greatest]) => write!(
                        f,
                        "at {time:.3} s, with N = {axial:.4} kN/m, M = {moment:.4} kN m/m is {utilisation:.3} times what it bears ({:.4} to {:.4} kN m/m)",
                        1e-3 * least,
                        1e-3 * greatest
                    )?,
                    None => write!(
                        f,
                        "at {time:.3} s it does not bear N = {axial:.4} kN/m with any moment (utilisation {utilisation:.3})"
                    )?,
                }
                f.write_str("; an elastic lining is then computed too stiff, and its forces are not those of the concrete")
            }
            Self::CrackEnergy {
                dissipated,
                recovery,
                integration,
            } => {
                let gave = (*recovery > 0.0).then(|| {
                    format!(
                        "the stiffness that returned when cracks closed gave the body {recovery:.2e} J"
                    )
                });
                let erred = (*integration != 0.0).then(|| {
                    format!("the time integration of the laws erred by {integration:.2e} J")
                });
                let causes: Vec<String> = gave.into_iter().chain(erred).collect();
                write!(
                    f,
                    "{}, where plastic flow and damage took {dissipated:.2e} J: peaks of acceleration, plastic strain, displacement and section forces of the parts that crack depend on the time step and on rounding, and may be too large by far; compare with a shorter step (`safety = 0.4` in `[time]`){} and with an elastic run",
                    causes.join(", and "),
                    match *recovery > 0.0 {
                        true => ", with a law without recovery (`stiffness_recovery = 0`)",
                        false => "",
                    }
                )
            }
            Self::DividedSection {
                section,
                set,
                pieces,
                half_extent,
            } => {
                write!(
                    f,
                    "section '{section}' cuts {} pieces of '{set}' that do not touch: ",
                    pieces.len()
                )?;
                for piece in pieces.iter().take(SHOWN_PIECES) {
                    let SectionPiece {
                        elements,
                        centroid: c,
                        width,
                        depth,
                        ..
                    } = piece;
                    write!(
                        f,
                        "{} elements about ({:.3}, {:.3}, {:.3}) m, {width:.3} m along and {depth:.3} m across; ",
                        elements.len(),
                        c.x,
                        c.y,
                        c.z
                    )?;
                }
                if let more @ 1.. = pieces.len().saturating_sub(SHOWN_PIECES) {
                    write!(f, "{more} more; ")?;
                }
                write!(
                    f,
                    "its forces are the sums over all of them and its moments are about their common centroid, not those of one piece; "
                )?;
                match half_extent {
                    Some([least, most]) => write!(
                        f,
                        "`half_extent` from {least} to {most} m takes the piece nearest to `at` alone"
                    ),
                    None => write!(
                        f,
                        "for one piece alone, give a point of it as `at`, and a `half_extent` that leaves out the others"
                    ),
                }
            }
            Self::ReducedStrength {
                joint,
                factor,
                area,
                of,
            } => write!(
                f,
                "the mesh does not resolve how the bond of joint '{joint}' fails: its strength is reduced to {factor:.2} of its own, its fracture energies are kept, on {:.0} % of its area ({area:.1} m2); cracks begin too early, their energy and final area are as with smaller elements",
                100.0 * area / of
            ),
            Self::JointRenewed {
                joint,
                stage,
                renewal,
            } => {
                write!(
                    f,
                    "opening, slip and energies of joint '{joint}' are counted from "
                )?;
                match stage {
                    Some(stage) => write!(f, "its position before stage '{stage}'")?,
                    None => write!(f, "its position at the start of the run")?,
                }
                match renewal {
                    Renewal::Grouted => write!(f, ", where it was grouted"),
                    Renewal::Released => write!(f, ", where its tie was removed"),
                }
            }
            Self::NonlinearRim { set, law } => write!(
                f,
                "part '{set}' with the law '{law}' touches an absorbing face: the free field is elastic, so yielding there reflects the waves; give the part a rim"
            ),
            Self::DampedHistory { set, law } => write!(
                f,
                "part '{set}' with the law '{law}' has stiffness-proportional damping: where it yields or cracks the damping is proportional to the degraded stiffness, and its stress adds to that of the law, so that the total may exceed the strength; outputs of stress and section forces do not contain it. Flat damping stays within the strength: damping = {{ kind = \"flat\", ... }}"
            ),
            Self::HeavyFibres { share } => write!(
                f,
                "the added inertia of fibres takes {:.1} % of the kinetic energy of their masses, more than 1 %: frequencies of their motion are up to {:.1} % too low, and accelerations, shear forces and floor spectra feel it; take a smaller factor (`fibres` in [time])",
                100.0 * share,
                50.0 * share
            ),
            Self::Hourglass { stage, set, share } => {
                let prefix = match stage {
                    Some(stage) => format!("in stage '{stage}' "),
                    None => String::new(),
                };
                write!(
                    f,
                    "{prefix}hourglass resistance takes {:.1} % of the internal work of set '{set}', more than 1 %: displacements and stresses there are affected by it; use the kernel \"hex8-natural\", \"hex8-full\" or \"hex8-b-bar\", or smaller elements",
                    100.0 * share
                )
            }
            Self::Unbalanced {
                stage,
                share,
                displacement,
                node,
            } => write!(
                f,
                "the in-situ stress leaves an unbalanced force of {:.1} % of the load at the start of stage '{stage}', and the body moved by up to {displacement:.3e} m (node {node}) until equilibrium: stress, density, gravity, surface loads and supports are inconsistent, and the stress is no longer the given one (in a mesh that is hollow from the start the force is that of its opening)",
                100.0 * share
            ),
            Self::Undersampled {
                name,
                interval,
                band: Some(band),
            } => write!(
                f,
                "the acceleration of '{name}' has frequencies above those that its means over {interval} s show, as when cracks open or close: spectra, intensities and peaks of the rows of histories.csv are wrong; those of accelerations.csv, from which plots and reports are, hold up to {band} Hz (a shorter `every` shows more)"
            ),
            Self::Undersampled {
                name,
                interval,
                band: None,
            } => write!(
                f,
                "the acceleration of '{name}' has frequencies above those that samples every {interval} s resolve, as when cracks open or close: around its peak they change by more than its own size, or miss it; spectra, Fourier amplitudes and intensities of these samples are aliased, and may be wrong by more than a factor of ten (`band = 100` in [output], with `acceleration = \"mean\"`, records what they can be computed from)"
            ),
            Self::SparseEnvelope { share } => write!(
                f,
                "every second sample of the envelope gives only {:.0} % of its greatest acceleration: its sampling interval is too long and misses peaks; reduce it (`every`)",
                100.0 * share
            ),
            Self::FlatDamping {
                set,
                cost,
                by_default,
            } => {
                let of = match by_default {
                    true => {
                        " (that of the preset of its material; `damping = \"none\"` switches it off)"
                    }
                    false => "",
                };
                write!(f, "damping of part '{set}'{of}: {cost}")
            }
            Self::PoreWater(material) => write!(f, "{material}"),
            Self::WaterWarning(warning) => write!(f, "{warning}"),
            Self::AddedWater(water) => write!(f, "{water}"),
            Self::Rim {
                set,
                width,
                elements,
                of,
            } => {
                let within = match *width {
                    0.0 => "touch the absorbing faces".to_owned(),
                    width => format!("touch the absorbing faces or are within {width} m of them"),
                };
                write!(
                    f,
                    "rim of part '{set}': {elements} of its {of} elements {within}; they are elastic and undamped"
                )
            }
            Self::Material { set, warning } => write!(f, "material of part '{set}': {warning}"),
            Self::DampedRim { set } => write!(
                f,
                "part '{set}' touches an absorbing face with another damping than the free field has there, so waves are partly reflected: give the part the damping of the layers that it lies in, or, where the field is elastic, a rim"
            ),
        }
    }
}

/// Letters of components in words.
fn list(letters: &str) -> String {
    let letters: Vec<String> = letters.chars().map(String::from).collect();
    letters.join(" and ")
}
