//! Modifications of the scene by a configuration: lamp size, and representation of surfaces of
//! revolution.

use serde::{Deserialize, Serialize};

use super::StudyError;
use super::lamps::{Lamp, with_lamp};
use super::revolutions::{Newton, Revolutions, with_newton, with_revolutions};
use crate::scene::Scene;

/// Modifications of the scene that a grid can make.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Variant {
    /// Size of the lamps; `None` leaves them unchanged. Affects the reference.
    pub lamp: Option<Lamp>,
    /// Representation of surfaces of revolution.
    pub revolutions: Revolutions,
    /// Accuracy of ray intersections with exact surfaces of revolution.
    pub newton: Newton,
}

impl Variant {
    /// Applies the modifications to a scene.
    ///
    /// # Errors
    /// If the scene does not contain or support what is to be modified.
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
