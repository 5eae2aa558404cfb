//! How a configuration's scene differs from its file: the size of the lamps, and what surfaces of
//! revolution are made of.

use serde::{Deserialize, Serialize};

use super::StudyError;
use super::lamps::{Lamp, with_lamp};
use super::revolutions::{Newton, Revolutions, with_newton, with_revolutions};
use crate::scene::Scene;

/// What a grid changes in the scene itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Variant {
    /// The size that the lamps are given; none leaves them as they are. It changes the true
    /// picture.
    pub lamp: Option<Lamp>,
    /// What surfaces of revolution are made of.
    pub revolutions: Revolutions,
    /// How exactly rays meet them.
    pub newton: Newton,
}

impl Variant {
    /// The scene with the changes.
    ///
    /// # Errors
    /// Where the scene has nothing to change, or it cannot be so.
    pub fn of(&self, scene: &Scene) -> Result<Scene, StudyError> {
        let mut changed = scene.clone();
        let fault = |choice: String| |what| StudyError::Variant { choice, what };
        if let Some(lamp) = self.lamp {
            changed = with_lamp(&changed, lamp).map_err(fault(format!("lamp_area={lamp}")))?;
        }
        let newton = self.newton;
        if newton != Newton::Least {
            changed = with_newton(&changed, newton)
                .map_err(fault(format!("newton_tolerance={newton}")))?;
        }
        let revolutions = self.revolutions;
        if revolutions != Revolutions::Exact {
            let choice = format!("revolutions={revolutions}");
            changed = with_revolutions(&changed, revolutions).map_err(fault(choice))?;
        }
        Ok(changed)
    }
}
