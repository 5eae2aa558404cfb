//! Dielectrics by name: index of refraction at the helium d line, and dispersion.
//!
//! The coefficients are those of the publications, as listed in the refractiveindex.info database
//! (M. N. Polyanskiy, Scientific Data 11, 94 (2024); released under CC0). Indices are as published:
//! those of air and water are relative to vacuum, those of optical catalogs to air. The two differ
//! by a factor of 1.0003. Absorption is not included.

use super::same_name;

/// Wavelength of the helium d line, nm.
pub const D_LINE_NM: f64 = 587.561_8;

/// A transparent material. Birefringent crystals have the index of their ordinary ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glass {
    /// Name in scene files.
    pub name: &'static str,
    /// Other accepted names.
    pub aliases: &'static [&'static str],
    /// Index of refraction at [`D_LINE_NM`].
    pub ior: f64,
    /// Index over wavelength.
    pub dispersion: Dispersion,
    /// Wavelengths of the measurement, nm.
    pub range_nm: [f64; 2],
    /// Publication of the measurement, with the temperature where it matters.
    pub source: &'static str,
}

/// Index of refraction `n` over the wavelength `l` in micrometers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Dispersion {
    /// The same index at all wavelengths: no dispersion is known in visible light.
    Constant,
    /// Sellmeier: `n^2 = 1 + offset + sum of B l^2 / (l^2 - C)`. The offset and pairs `(B, C)`, `C`
    /// in micrometers^2.
    Sellmeier(f64, &'static [(f64, f64)]),
    /// Polynomial: `n^2 = sum of a l^p`. Pairs `(a, p)`.
    Polynomial(&'static [(f64, i32)]),
    /// Cauchy: `n = sum of a l^p`. Pairs `(a, p)`.
    Cauchy(&'static [(f64, i32)]),
    /// Gases: `n = 1 + sum of B / (C - l^-2)`. Pairs `(B, C)`, both in micrometers^-2.
    Gas(&'static [(f64, f64)]),
    /// Samples `(wavelength in nm, index)`, interpolated linearly.
    Table(&'static [(f64, f64)]),
}

impl Glass {
    /// Index of refraction at a wavelength in nm; at least 1 from 380 to 780 nm. Wavelengths out of
    /// `range_nm` are extrapolated.
    pub fn index_at(&self, wavelength_nm: f64) -> f64 {
        let um = 1e-3 * wavelength_nm;
        let square = um * um;
        match self.dispersion {
            Dispersion::Constant => self.ior,
            Dispersion::Sellmeier(offset, terms) => {
                let sum: f64 = terms.iter().map(|(b, c)| b * square / (square - c)).sum();
                (1.0 + offset + sum).sqrt()
            }
            Dispersion::Polynomial(terms) => power_series(terms, um).sqrt(),
            Dispersion::Cauchy(terms) => power_series(terms, um),
            Dispersion::Gas(terms) => {
                1.0 + terms.iter().map(|(b, c)| b / (c - 1.0 / square)).sum::<f64>()
            }
            Dispersion::Table(samples) => {
                let above = samples.partition_point(|sample| sample.0 < wavelength_nm);
                let above = above.clamp(1, samples.len() - 1);
                let (from, to) = (samples[above - 1], samples[above]);
                let t = (wavelength_nm - from.0) / (to.0 - from.0);
                from.1 + t.clamp(0.0, 1.0) * (to.1 - from.1)
            }
        }
    }
}

/// The glass with this name or alias, in any case, with or without hyphens and underscores.
pub fn glass(name: &str) -> Option<&'static Glass> {
    GLASSES.iter().find(|glass| {
        same_name(glass.name, name) || glass.aliases.iter().any(|alias| same_name(alias, name))
    })
}

/// Names of all glasses, in alphabetical order.
pub fn glass_names() -> impl Iterator<Item = &'static str> {
    GLASSES.iter().map(|glass| glass.name)
}

/// Sum of `a x^p` over pairs `(a, p)`.
fn power_series(terms: &[(f64, i32)], x: f64) -> f64 {
    terms.iter().map(|&(a, p)| a * x.powi(p)).sum()
}

/// Square of a resonance wavelength: some publications state this instead of `C`.
const fn sq(wavelength: f64) -> f64 {
    wavelength * wavelength
}

const SCHOTT: &str = "Schott, optical glass catalog (2017-01-20)";
const SULTANOVA: &str = "Sultanova, Kasarova and Nikolov, Acta Phys. Pol. A 116, 585 (2009): 20 C";

/// All glasses, in alphabetical order.
pub const GLASSES: &[Glass] = &[
    Glass {
        name: "acrylic",
        aliases: &["PMMA", "plexiglass", "polymethyl methacrylate"],
        ior: 1.49253,
        dispersion: Dispersion::Polynomial(&[
            (2.1778, 0),
            (6.1209e-3, 2),
            (-1.5004e-3, 4),
            (2.3678e-2, -2),
            (-4.2137e-3, -4),
            (7.3417e-4, -6),
            (-4.5042e-5, -8),
        ]),
        range_nm: [420.0, 1620.0],
        source: "Beadie et al., Appl. Opt. 54, F139 (2015): 20.1 C",
    },
    Glass {
        name: "air",
        aliases: &[],
        ior: 1.000277,
        dispersion: Dispersion::Gas(&[(0.05792105, 238.0185), (0.00167917, 57.362)]),
        range_nm: [230.0, 1690.0],
        source: "Ciddor, Appl. Opt. 35, 1566 (1996): dry, 15 C, 101.325 kPa, 450 ppm CO2",
    },
    Glass {
        name: "baf10",
        aliases: &["N-BAF10"],
        ior: 1.67003,
        dispersion: Dispersion::Sellmeier(
            0.0,
            &[(1.5851495, 0.00926681282), (0.143559385, 0.0424489805), (1.08521269, 105.613573)],
        ),
        range_nm: [350.0, 2500.0],
        source: SCHOTT,
    },
    Glass {
        name: "bak4",
        aliases: &["N-BAK4"],
        ior: 1.56883,
        dispersion: Dispersion::Sellmeier(
            0.0,
            &[(1.28834642, 0.00779980626), (0.132817724, 0.0315631177), (0.945395373, 105.965875)],
        ),
        range_nm: [334.0, 2500.0],
        source: SCHOTT,
    },
    Glass {
        name: "bk7",
        aliases: &["N-BK7", "crown glass"],
        ior: 1.51680,
        dispersion: Dispersion::Sellmeier(
            0.0,
            &[(1.03961212, 0.00600069867), (0.231792344, 0.0200179144), (1.01046945, 103.560653)],
        ),
        range_nm: [300.0, 2500.0],
        source: SCHOTT,
    },
    Glass {
        name: "borosilicate",
        aliases: &["borofloat", "borofloat 33"],
        ior: 1.47149,
        dispersion: Dispersion::Sellmeier(0.3542, &[(0.78657, sq(0.10856)), (0.18285, sq(4.427))]),
        range_nm: [240.0, 1550.0],
        source: "Schott, Borofloat 33 optical properties (2021)",
    },
    Glass {
        name: "cubic_zirconia",
        aliases: &["zirconia"],
        ior: 2.15877,
        dispersion: Dispersion::Sellmeier(
            0.0,
            &[(1.347091, sq(0.062543)), (2.117788, sq(0.166739)), (9.452943, sq(24.32057))],
        ),
        range_nm: [361.0, 5135.0],
        source: "Wood and Nassau, Appl. Opt. 21, 2978 (1982): 12 mol % Y2O3, 25 C",
    },
    Glass {
        name: "diamond",
        aliases: &[],
        ior: 2.41749,
        dispersion: Dispersion::Sellmeier(0.0, &[(0.3306, sq(0.175)), (4.3356, sq(0.106))]),
        range_nm: [226.0, 760.0],
        source: "Peter, Z. Phys. 15, 358 (1923)",
    },
    Glass {
        name: "ethanol",
        aliases: &["alcohol"],
        ior: 1.36168,
        dispersion: Dispersion::Cauchy(&[(1.35265, 0), (0.00306, -2), (0.00002, -4)]),
        range_nm: [476.5, 830.0],
        source: "Rheims, Köser and Wriedt, Meas. Sci. Technol. 8, 601 (1997): 20 C",
    },
    Glass {
        name: "f2",
        aliases: &["flint glass"],
        ior: 1.62004,
        dispersion: Dispersion::Sellmeier(
            0.0,
            &[(1.34533359, 0.00997743871), (0.209073176, 0.0470450767), (0.937357162, 111.886764)],
        ),
        range_nm: [320.0, 2500.0],
        source: SCHOTT,
    },
    Glass {
        name: "fk51a",
        aliases: &["N-FK51A"],
        ior: 1.48656,
        dispersion: Dispersion::Sellmeier(
            0.0,
            &[(0.971247817, 0.00472301995), (0.216901417, 0.0153575612), (0.904651666, 168.68133)],
        ),
        range_nm: [290.0, 2500.0],
        source: SCHOTT,
    },
    Glass {
        name: "fluorite",
        aliases: &["calcium fluoride", "CaF2"],
        ior: 1.43388,
        dispersion: Dispersion::Sellmeier(
            0.0,
            &[
                (0.443749998, 0.00178027854),
                (0.444930066, 0.00788536061),
                (0.150133991, 0.0124119491),
                (8.85319946, 2752.28175),
            ],
        ),
        range_nm: [138.0, 2326.0],
        source: "Daimon and Masumura, Appl. Opt. 41, 5275 (2002): 20 C",
    },
    Glass {
        name: "fused_silica",
        aliases: &["silica", "quartz glass"],
        ior: 1.45846,
        dispersion: Dispersion::Sellmeier(
            0.0,
            &[(0.6961663, sq(0.0684043)), (0.4079426, sq(0.1162414)), (0.8974794, sq(9.896161))],
        ),
        range_nm: [210.0, 6700.0],
        source: "Malitson, J. Opt. Soc. Am. 55, 1205 (1965): 20 C",
    },
    Glass {
        name: "glycerol",
        aliases: &["glycerin", "glycerine"],
        ior: 1.47227,
        dispersion: Dispersion::Constant,
        range_nm: [589.3, 1050.0],
        source: "Rheims, Köser and Wriedt, Meas. Sci. Technol. 8, 601 (1997): 25 C",
    },
    Glass {
        name: "ice",
        aliases: &["water ice"],
        ior: 1.30977,
        dispersion: Dispersion::Table(&[
            (350.0, 1.3249),
            (400.0, 1.3194),
            (420.0, 1.3177),
            (440.0, 1.3163),
            (460.0, 1.3151),
            (480.0, 1.314),
            (500.0, 1.313),
            (520.0, 1.3121),
            (540.0, 1.3114),
            (560.0, 1.3106),
            (580.0, 1.31),
            (600.0, 1.3094),
            (620.0, 1.3088),
            (640.0, 1.3083),
            (660.0, 1.3078),
            (680.0, 1.3073),
            (700.0, 1.3069),
            (720.0, 1.3065),
            (740.0, 1.306),
            (760.0, 1.3057),
            (780.0, 1.3053),
            (800.0, 1.3049),
        ]),
        range_nm: [350.0, 800.0],
        source: "Warren and Brandt, J. Geophys. Res. 113, D14220 (2008): -7 C",
    },
    Glass {
        name: "lasf9",
        aliases: &["N-LASF9"],
        ior: 1.85025,
        dispersion: Dispersion::Sellmeier(
            0.0,
            &[(2.00029547, 0.0121426017), (0.298926886, 0.0538736236), (1.80691843, 156.530829)],
        ),
        range_nm: [365.0, 2500.0],
        source: SCHOTT,
    },
    Glass {
        name: "polycarbonate",
        aliases: &["PC", "lexan"],
        ior: 1.58476,
        dispersion: Dispersion::Sellmeier(0.0, &[(1.4182, 0.021304)]),
        range_nm: [436.8, 1052.0],
        source: SULTANOVA,
    },
    Glass {
        name: "polystyrene",
        aliases: &["PS"],
        ior: 1.59163,
        dispersion: Dispersion::Sellmeier(0.0, &[(1.4435, 0.020216)]),
        range_nm: [436.8, 1052.0],
        source: SULTANOVA,
    },
    Glass {
        name: "quartz",
        aliases: &["rock crystal"],
        ior: 1.54428,
        dispersion: Dispersion::Sellmeier(
            0.28604141,
            &[(1.07044083, 0.0100585997), (1.10202242, 100.0)],
        ),
        range_nm: [198.0, 2053.1],
        source: "Ghosh, Opt. Commun. 163, 95 (1999): ordinary ray",
    },
    Glass {
        name: "salt",
        aliases: &["rock salt", "halite", "NaCl"],
        ior: 1.54421,
        dispersion: Dispersion::Sellmeier(
            0.00055,
            &[
                (0.198, sq(0.05)),
                (0.48398, sq(0.1)),
                (0.38696, sq(0.128)),
                (0.25998, sq(0.158)),
                (0.08796, sq(40.5)),
                (3.17064, sq(60.98)),
                (0.30038, sq(120.34)),
            ],
        ),
        range_nm: [200.0, 30000.0],
        source: "Li, J. Phys. Chem. Ref. Data 5, 329 (1976): 24 C",
    },
    Glass {
        name: "sapphire",
        aliases: &["corundum", "Al2O3"],
        ior: 1.76817,
        dispersion: Dispersion::Sellmeier(
            0.0,
            &[(1.4313493, sq(0.0726631)), (0.65054713, sq(0.1193242)), (5.3414021, sq(18.028251))],
        ),
        range_nm: [200.0, 5000.0],
        source: "Malitson and Dodge, J. Opt. Soc. Am. 62, 1405 (1972): ordinary ray, 20 C",
    },
    Glass {
        name: "sf10",
        aliases: &[],
        ior: 1.72825,
        dispersion: Dispersion::Sellmeier(
            0.0,
            &[(1.61625977, 0.0127534559), (0.259229334, 0.0581983954), (1.07762317, 116.60768)],
        ),
        range_nm: [380.0, 2500.0],
        source: SCHOTT,
    },
    Glass {
        name: "sf11",
        aliases: &[],
        ior: 1.78472,
        dispersion: Dispersion::Sellmeier(
            0.0,
            &[(1.73848403, 0.0136068604), (0.311168974, 0.0615960463), (1.17490871, 121.922711)],
        ),
        range_nm: [390.0, 2500.0],
        source: SCHOTT,
    },
    Glass {
        name: "soda_lime",
        aliases: &["window glass", "float glass"],
        ior: 1.52338,
        dispersion: Dispersion::Cauchy(&[(1.513, 0), (-0.003169, 2), (0.003962, -2)]),
        range_nm: [310.0, 4600.0],
        source: "Rubin, Sol. Energy Mater. 12, 275 (1985): clear window glass",
    },
    Glass {
        name: "vacuum",
        aliases: &[],
        ior: 1.0,
        dispersion: Dispersion::Constant,
        range_nm: [0.0, f64::INFINITY],
        source: "exact",
    },
    Glass {
        name: "water",
        aliases: &["H2O"],
        ior: 1.33340,
        dispersion: Dispersion::Sellmeier(
            0.0,
            &[
                (0.5684027565, 0.005101829712),
                (0.1726177391, 0.01821153936),
                (0.02086189578, 0.02620722293),
                (0.1130748688, 10.69792721),
            ],
        ),
        range_nm: [182.0, 1129.0],
        source: "Daimon and Masumura, Appl. Opt. 46, 3811 (2007): 20 C",
    },
];
