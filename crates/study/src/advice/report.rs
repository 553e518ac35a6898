//! Advice in words.

use core::fmt;

use powerhouse::boundary::Spreading;

use super::{BoundaryAdvice, Drive};

impl BoundaryAdvice {
    /// The `[boundary]` table of a scene for the boundary that is named.
    #[must_use]
    pub fn table(&self) -> Option<String> {
        let named = self.named()?;
        let mut table = String::from("[boundary]\n");
        table.push_str(&named.kind.keys(&self.standing, &self.bottom));
        table.push_str(&format!("faces = {:?}\n", self.faces));
        let [x, y, z] = self.setting.centre.into();
        table.push_str(&format!("scatterer = [{x}, {y}, {z}]\n"));
        Some(table)
    }

    /// Why the named boundary is named, or why none is.
    #[must_use]
    pub fn reason(&self) -> String {
        if self.setting.radius.is_none() {
            return "nothing scatters: the body moves as the field does, and its faces carry nothing"
                .into();
        }
        let limit = 100.0 * self.error;
        let Some(named) = self.named() else {
            let best = self.candidates.first();
            let least = best.map_or(f64::NAN, |best| 100.0 * best.predicted);
            let farther = match &self.farther {
                Some(farther) => format!(
                    "{} on faces {} times as far is predicted to err by {:.2} %",
                    farther.kind.name(),
                    farther.times,
                    100.0 * farther.predicted
                ),
                None => "nor does it on faces twice as far".into(),
            };
            return format!(
                "no boundary meets {limit:.2} %, the best errs by {least:.2} %: {farther}"
            );
        };
        let others = self.candidates.iter().filter(|c| c.predicted > self.error);
        let others = match others.count() {
            0 => "all others meet it too, with larger errors at the same cost".to_owned(),
            count => format!("{count} of the others miss it"),
        };
        let [p, sv] = named.returned.map(|share| 100.0 * share);
        let holds = match named.kind.holds() {
            true => "holds the body against lasting forces",
            false => "does not hold the body against lasting forces",
        };
        format!(
            "errs least among those that meet {limit:.2} % ({others}); straight on it returns {p:.1} % of P and {sv:.1} % of SV waves at the nearest face, and {holds}"
        )
    }
}

impl fmt::Display for BoundaryAdvice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let setting = &self.setting;
        writeln!(f, "{}", self.title)?;
        let medium = &setting.medium;
        writeln!(
            f,
            "  ground: P {:.0} m/s, S {:.0} m/s",
            medium.p_speed(),
            medium.s_speed()
        )?;
        let [x, y, z] = setting.centre.into();
        match setting.radius {
            Some(radius) => writeln!(
                f,
                "  what scatters: within {radius:.1} m of ({x:.1}, {y:.1}, {z:.1}) m"
            )?,
            None => writeln!(f, "  nothing scatters")?,
        }
        let faces = [('x', 0), ('y', 1), ('z', 2)].map(|(axis, place)| {
            let distances = setting.distances[place];
            let told = distances.map(|d| d.map_or("-".to_owned(), |d| format!("{d:.1}")));
            format!("{axis} {} {}", told[0], told[1])
        });
        writeln!(f, "  faces from there, m: {}", faces.join(", "))?;
        match &setting.drive {
            Drive::Waves { waves, band } => {
                for wave in waves {
                    let degrees = wave.incidence.degrees();
                    writeln!(f, "  {} wave at {degrees:.1} degrees", wave.kind)?;
                }
                writeln!(
                    f,
                    "  99 % of the energy of velocity below {:.2} Hz, in the mean {:.2} Hz",
                    band.highest,
                    band.mean()
                )?;
            }
            Drive::Loads { duration } => {
                writeln!(
                    f,
                    "  loads over {duration} s, taken to be sudden and lasting"
                )?;
            }
        }
        if let Some([small, large]) = self.model {
            let spreads = match (&setting.drive, setting.spreading) {
                (Drive::Loads { .. }, Spreading::Spherical) => "a spherical cavity",
                _ => "a circular opening in plane strain",
            };
            writeln!(
                f,
                "  predicted by {spreads}: {small} elements against {large}, up to {:.2} Hz",
                self.highest
            )?;
        }
        writeln!(
            f,
            "\n  {:<48} {:>9} {:>8} {:>9} {:>9} {:>6}",
            "boundary", "predicted", "ns/node", "of a step", "elements", "step"
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
                    "  misses"
                }
            )?;
        }
        for left_out in &self.left_out {
            writeln!(
                f,
                "  {} is no candidate: {}",
                left_out.name, left_out.reason
            )?;
        }
        writeln!(f, "\n{}", self.reason())?;
        match (self.named(), self.table()) {
            (Some(named), Some(table)) => write!(f, "named: {}\n\n{table}", named.kind.name()),
            _ => Ok(()),
        }
    }
}
