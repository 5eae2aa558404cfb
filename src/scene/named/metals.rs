//! Metals by name: one complex index of refraction per channel of linear Rec. 709.
//!
//! The values are derived from measured spectra. With the exact Fresnel equations of a conductor
//! they reproduce, per channel, the color of the metal under D65 at normal incidence, and the
//! reflectance at other angles with the least mean square error. `docs/metals.md` describes the
//! derivation; `cargo run --example named_metals` repeats it and prints this table.

use super::same_name;

/// A metal in vacuum or air, with a smooth clean surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metal {
    /// Name in scene files.
    pub name: &'static str,
    /// Other accepted names.
    pub aliases: &'static [&'static str],
    /// Index of refraction, for red, green and blue.
    pub eta: [f64; 3],
    /// Extinction coefficient, for red, green and blue.
    pub k: [f64; 3],
    /// Publication of the measurement.
    pub source: &'static str,
}

impl Metal {
    /// Reflectance at normal incidence, in [0, 1], for red, green and blue.
    pub fn reflectance(&self) -> [f64; 3] {
        std::array::from_fn(|c| {
            let (eta, k) = (self.eta[c], self.k[c]);
            let below = (eta - 1.0) * (eta - 1.0) + k * k;
            let above = (eta + 1.0) * (eta + 1.0) + k * k;
            below / above
        })
    }
}

/// The metal with this name or alias, in any case, with or without hyphens and underscores.
pub fn metal(name: &str) -> Option<&'static Metal> {
    METALS.iter().find(|metal| {
        same_name(metal.name, name) || metal.aliases.iter().any(|alias| same_name(alias, name))
    })
}

/// Names of all metals, in alphabetical order.
pub fn metal_names() -> impl Iterator<Item = &'static str> {
    METALS.iter().map(|metal| metal.name)
}

const JOHNSON_1974: &str = "Johnson and Christy, Phys. Rev. B 9, 5056 (1974)";

/// All metals, in alphabetical order.
pub const METALS: &[Metal] = &[
    Metal {
        name: "aluminium",
        aliases: &["aluminum", "Al"],
        eta: [1.1928, 0.7654, 0.4656],
        k: [6.7830, 5.7785, 4.6786],
        source: "McPeak et al., ACS Photonics 2, 326 (2015)",
    },
    Metal {
        name: "brass",
        aliases: &["CuZn"],
        eta: [0.4637, 0.5230, 1.1252],
        k: [4.2883, 2.6676, 1.8113],
        source: "Querry, report CRDC-CR-85034 (1985): 70 % Cu, 30 % Zn",
    },
    Metal {
        name: "chromium",
        aliases: &["chrome", "Cr"],
        eta: [3.2472, 3.1139, 2.2865],
        k: [3.2865, 3.3362, 3.1171],
        source: JOHNSON_1974,
    },
    Metal {
        name: "cobalt",
        aliases: &["Co"],
        eta: [2.2574, 2.0352, 1.7133],
        k: [4.2280, 3.7945, 3.2381],
        source: JOHNSON_1974,
    },
    Metal {
        name: "copper",
        aliases: &["Cu"],
        eta: [0.2078, 0.9720, 1.2119],
        k: [4.0377, 2.6245, 2.3593],
        source: "Hagemann, Gudat and Kunz, J. Opt. Soc. Am. 65, 742 (1975)",
    },
    Metal {
        name: "gold",
        aliases: &["Au"],
        eta: [0.1239, 0.3811, 1.5363],
        k: [4.8340, 2.1992, 1.6740],
        source: "Olmon et al., Phys. Rev. B 86, 235147 (2012): evaporated film",
    },
    Metal {
        name: "iridium",
        aliases: &["Ir"],
        eta: [3.0787, 2.5968, 2.1479],
        k: [5.6278, 5.0774, 4.3342],
        source: "Schmitt et al., Opt. Mater. Express 12, 545 (2022): sputtered film",
    },
    Metal {
        name: "iron",
        aliases: &["Fe"],
        eta: [2.9230, 2.9191, 2.5461],
        k: [3.0773, 2.9373, 2.7500],
        source: JOHNSON_1974,
    },
    Metal {
        name: "lead",
        aliases: &["Pb"],
        eta: [2.6120, 2.5548, 2.0570],
        k: [4.1714, 4.1827, 4.1755],
        source: "Mathewson and Myers, Phys. Scr. 4, 291 (1971): 298 K",
    },
    Metal {
        name: "mercury",
        aliases: &["quicksilver", "Hg"],
        eta: [2.0486, 1.5193, 1.0249],
        k: [5.3100, 4.6058, 3.7950],
        source: "Inagaki, Arakawa and Williams, Phys. Rev. B 23, 5246 (1981): liquid",
    },
    Metal {
        name: "molybdenum",
        aliases: &["Mo"],
        eta: [4.9506, 5.0711, 4.5691],
        k: [3.6571, 3.8069, 3.8352],
        source: "Querry, report CRDEC-CR-88009 (1987)",
    },
    Metal {
        name: "nickel",
        aliases: &["Ni"],
        eta: [2.0338, 1.9033, 1.7287],
        k: [4.2017, 3.5702, 2.8960],
        source: JOHNSON_1974,
    },
    Metal {
        name: "palladium",
        aliases: &["Pd"],
        eta: [1.7962, 1.6218, 1.3958],
        k: [4.3654, 3.8118, 3.2127],
        source: JOHNSON_1974,
    },
    Metal {
        name: "platinum",
        aliases: &["Pt"],
        eta: [2.2181, 1.9104, 1.6380],
        k: [5.1781, 4.4559, 3.7054],
        source: "Tselin et al., Phys. Rev. B 110, 195130 (2024)",
    },
    Metal {
        name: "rhodium",
        aliases: &["Rh"],
        eta: [2.1734, 1.9612, 1.7255],
        k: [5.7238, 4.9549, 4.4014],
        source: "Weaver, Olson and Lynch, Phys. Rev. B 15, 4115 (1977), tabulated by Palik (1985)",
    },
    Metal {
        name: "silver",
        aliases: &["Ag"],
        eta: [0.0600, 0.0533, 0.0530],
        k: [4.2755, 3.4753, 2.5473],
        source: "Yang et al., Phys. Rev. B 91, 235137 (2015): template-stripped film",
    },
    Metal {
        name: "stainless_steel",
        aliases: &["steel"],
        eta: [2.4135, 2.0214, 1.6526],
        k: [4.1890, 3.6417, 3.0700],
        source: "Karlsson and Ribbing, J. Appl. Phys. 53, 6340 (1982): austenitic",
    },
    Metal {
        name: "titanium",
        aliases: &["Ti"],
        eta: [2.7480, 2.5077, 2.2400],
        k: [3.8437, 3.3974, 3.0148],
        source: JOHNSON_1974,
    },
    Metal {
        name: "tungsten",
        aliases: &["wolfram", "W"],
        eta: [3.6372, 3.4939, 3.3150],
        k: [2.9236, 2.7475, 2.5062],
        source: "Weaver, Olson and Lynch, Phys. Rev. B 12, 1293 (1975)",
    },
    Metal {
        name: "vanadium",
        aliases: &["V"],
        eta: [3.4804, 3.9613, 3.6147],
        k: [2.9836, 3.0758, 3.4750],
        source: JOHNSON_1974,
    },
];
