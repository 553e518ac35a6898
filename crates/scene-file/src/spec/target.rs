//! Spectra of codes to which records are scaled or matched.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{At, NonNegative, Positive, Share, is_default};

/// Spectrum of a code to which a record is brought over a band of periods, in the place of `peak`.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct RecordSpectrum {
    /// The spectrum.
    pub target: At<Target>,
    /// Band of periods (s): the shortest, at least four steps of the record, and the longest.
    pub periods: At<[Positive; 2]>,
    /// Means: one factor for the record with all its components (the default), or wavelets that are added to each component.
    #[serde(default, skip_serializing_if = "is_default")]
    pub by: SpectrumMeans,
    /// Greatest distance of the ratio of spectra from 1 at which wavelets are enough, 0.05 by default.
    pub tolerance: Option<Share>,
}

/// Means by which a record gets a spectrum.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, Serialize, PartialEq, Eq)]
#[non_exhaustive]
#[serde(rename_all = "kebab-case")]
pub enum SpectrumMeans {
    /// One factor: over the band the mean logarithm of the ratio of spectra is zero, of components together.
    #[default]
    Factor,
    /// A factor, and then wavelets in time (Al Atik and Abrahamson 2010).
    Wavelets,
}

/// Elastic response spectrum of horizontal pseudo-acceleration.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[schemars(tag = "kind")]
#[serde(deny_unknown_fields)]
pub enum Target {
    /// EN 1998-1:2004, up to 4 s.
    #[serde(rename = "eurocode-8")]
    Eurocode8 {
        /// Type of the spectrum, 1 (magnitudes above 5.5) or 2.
        r#type: At<u8>,
        /// Ground type.
        ground: Ground8,
        /// Design ground acceleration on type A ground (m/s2), above 0.
        peak: Positive,
        /// Damping ratio, 0.05 by default.
        damping_ratio: Option<NonNegative>,
    },
    /// NB 35047-2015, hydraulic structures; with an amplification of 2.5 the plateau of GB 18306-2015.
    #[serde(rename = "nb-35047")]
    Nb35047 {
        /// Peak ground acceleration of the site (m/s2), above 0.
        peak: Positive,
        /// Amplification of the plateau, 1 to 5: 2.5 for arch dams, 2.25 for most structures of concrete.
        amplification: Positive,
        /// Characteristic period of the site (s), in the place of `zone` and `site`.
        characteristic_period: Option<Positive>,
        /// Characteristic period of the zone for class II (s): 0.35, 0.4 or 0.45.
        zone: Option<Positive>,
        /// Class of the site.
        site: Option<Site>,
        /// Damping ratio of the amplification, 0.05 by default.
        damping_ratio: Option<NonNegative>,
    },
    /// ASCE 7-16 at 5 % damping.
    #[serde(rename = "asce-7")]
    Asce7 {
        /// Design acceleration at short periods, S_DS (m/s2), above 0.
        short: Positive,
        /// Design acceleration at 1 s, S_D1 (m/s2), above 0.
        one_second: Positive,
        /// Period from which displacement is constant, T_L (s).
        long_period: Positive,
    },
    /// A table, for example of uniform hazard.
    #[serde(rename = "table")]
    Table {
        /// Periods (s, rising) with accelerations (m/s2, above 0); straight between them in logarithmic axes.
        points: At<Vec<[NonNegative; 2]>>,
        /// Damping ratio, 0.05 by default.
        damping_ratio: Option<NonNegative>,
    },
}

/// Ground type of Eurocode 8.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, Serialize, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Ground8 {
    A,
    B,
    C,
    D,
    E,
}

/// Site class of GB 18306-2015, from hard rock to very soft soil.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, Serialize, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Site {
    I0,
    I1,
    II,
    III,
    IV,
}
