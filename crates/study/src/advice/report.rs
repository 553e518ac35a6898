//! Text form of the comparison of boundaries.

use core::fmt;

use powerhouse::boundary::Spreading;

use super::{BoundaryAdvice, Excitation};

impl BoundaryAdvice {
    /// The `[boundary]` table of a scene for the recommended boundary; `None` if none meets the permitted error.
    #[must_use]
    pub fn table(&self) -> Option<String> {
        let named = self.recommended()?;
        let mut table = String::from("[boundary]\n");
        table.push_str(&named.kind.keys(&self.surroundings, &self.bottom));
        table.push_str(&format!("faces = {:?}\n", self.faces));
        let [x, y, z] = self.problem.centre.into();
        table.push_str(&format!("scatterer = [{x}, {y}, {z}]\n"));
        Some(table)
    }

    /// One sentence with the reason why the recommended boundary is recommended, or why none is.
    #[must_use]
    pub fn reason(&self) -> String {
        if self.problem.radius.is_none() {
            return "the scene has no scatterer: the body moves as the free field does, and any boundary is exact"
                .into();
        }
        let limit = 100.0 * self.error;
        let Some(named) = self.recommended() else {
            let best = self.candidates.first();
            let least = best.map_or(f64::NAN, |best| 100.0 * best.predicted);
            let farther = match &self.farther {
                Some(farther) => format!(
                    "{} with faces {} times as far has a predicted error of {:.2} %",
                    farther.kind.name(),
                    farther.times,
                    100.0 * farther.predicted
                ),
                None => "its error is above that with faces twice as far, too".into(),
            };
            return format!(
                "no boundary meets the permitted error of {limit:.2} %; the least predicted error is {least:.2} %: {farther}"
            );
        };
        let others = self.candidates.iter().filter(|c| c.predicted > self.error);
        let others = match others.count() {
            0 => "all others meet it too, with larger errors at equal cost".to_owned(),
            count => format!("{count} of the others exceed it"),
        };
        let [p, sv] = named.reflected.map(|share| 100.0 * share);
        let holds = if named.kind.resists_static_loads() {
            "resists static loads"
        } else {
            "does not resist static loads"
        };
        format!(
            "has the least predicted error among those within {limit:.2} % ({others}); at normal incidence on the nearest face it reflects {p:.1} % of P and {sv:.1} % of SV waves, and it {holds}"
        )
    }
}

impl fmt::Display for BoundaryAdvice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let problem = &self.problem;
        writeln!(f, "{}", self.title)?;
        let medium = &problem.medium;
        writeln!(
            f,
            "  ground: P {:.0} m/s, S {:.0} m/s",
            medium.p_speed(),
            medium.s_speed()
        )?;
        let [x, y, z] = problem.centre.into();
        match problem.radius {
            Some(radius) => writeln!(
                f,
                "  scatterer: within {radius:.1} m of ({x:.1}, {y:.1}, {z:.1}) m"
            )?,
            None => writeln!(f, "  no scatterer")?,
        }
        let faces = [('x', 0), ('y', 1), ('z', 2)].map(|(axis, index)| {
            let distances = problem.distances[index];
            let texts = distances.map(|d| d.map_or("-".to_owned(), |d| format!("{d:.1}")));
            format!("{axis} {} {}", texts[0], texts[1])
        });
        writeln!(
            f,
            "  distances from its centre to the faces (m): {}",
            faces.join(", ")
        )?;
        match &problem.excitation {
            Excitation::Waves { waves, band } => {
                for wave in waves {
                    let degrees = wave.incidence.degrees();
                    writeln!(f, "  {} wave at {degrees:.1} degrees", wave.kind)?;
                }
                writeln!(
                    f,
                    "  azimuths are not considered: waves travel in the section of the prediction, as they do across a long structure"
                )?;
                writeln!(
                    f,
                    "  99 % of the energy of velocity below {:.2} Hz, mean frequency {:.2} Hz",
                    band.highest,
                    band.mean()
                )?;
            }
            Excitation::Loads { duration } => {
                writeln!(f, "  loads over {duration} s, replaced by a pressure step")?;
            }
        }
        if let Some([small, large]) = self.model {
            let model = match (&problem.excitation, problem.spreading) {
                (Excitation::Loads { .. }, Spreading::Spherical) => "a spherical cavity",
                _ => "a circular opening in plane strain",
            };
            writeln!(
                f,
                "  predicted by {model}: {small} elements, reference of {large}, up to {:.2} Hz",
                self.highest
            )?;
        }
        writeln!(
            f,
            "\n  {:<48} {:>9} {:>8} {:>9} {:>9} {:>6}",
            "boundary", "error", "ns/node", "of a step", "elements", "step"
        )?;
        for candidate in &self.candidates {
            writeln!(
                f,
                "  {:<48} {:>7.2} % {:>8.0} {:>7.1} % {:>9} {:>6.3}{}",
                candidate.kind.name(),
                100.0 * candidate.predicted,
                candidate.nanoseconds,
                100.0 * candidate.share_of_step,
                candidate.extra_elements,
                candidate.stable_step,
                if candidate.predicted <= self.error {
                    ""
                } else {
                    "  exceeds the permitted error"
                }
            )?;
        }
        writeln!(
            f,
            "  (ns/node and share of a step: from figures of one machine, not measured here)"
        )?;
        for left_out in &self.left_out {
            writeln!(
                f,
                "  {} is no candidate: {}",
                left_out.name, left_out.reason
            )?;
        }
        writeln!(f, "\n{}", self.reason())?;
        match (self.recommended(), self.table()) {
            (Some(named), Some(table)) => {
                write!(f, "recommended: {}\n\n{table}", named.kind.name())
            }
            _ => Ok(()),
        }
    }
}
