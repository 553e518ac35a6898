//! Elastic media of published cases.

use powerhouse_model::ElasticMedium;

/// Elastic medium of the rock around the powerhouse: E 9 GPa, nu 0.27, 2750 kg/m3; P waves at
/// 2022 m/s, S waves at 1135 m/s.
///
/// Source: Wang, Chen & Xiao (2019), Table 1.
pub const ROCK: ElasticMedium = ElasticMedium {
    young: 9.0e9,
    poisson: 0.27,
    density: 2750.0,
};

/// Elastic medium of the concrete of the powerhouse: E 25 GPa, nu 0.17, 2500 kg/m3; P waves at
/// 3278 m/s, S waves at 2067 m/s.
///
/// Source: Wang, Chen & Xiao (2019), Table 1.
pub const CONCRETE: ElasticMedium = ElasticMedium {
    young: 25.0e9,
    poisson: 0.17,
    density: 2500.0,
};

#[cfg(test)]
mod tests {
    use super::*;

    /// The media are valid for their own constructor and have the wave speeds that are
    /// documented.
    #[test]
    fn published_media_are_valid() {
        for (medium, p, s) in [(ROCK, 2022.253, 1135.110), (CONCRETE, 3278.492, 2067.245)] {
            let checked = ElasticMedium::new(medium.young, medium.poisson, medium.density);
            assert_eq!(checked, Ok(medium));
            assert!((medium.p_speed() - p).abs() < 0.01, "{}", medium.p_speed());
            assert!((medium.s_speed() - s).abs() < 0.01, "{}", medium.s_speed());
        }
    }
}
