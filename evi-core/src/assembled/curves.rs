//! Curves of a frequency between two configurations, coordinate by coordinate.

use super::{AssemblyError, PreparedScene};
use crate::scheme::{
    Frequency, Linear, NodeCoefficients, Quadrature, SceneFrequencies, checked_coefficients, growth_rate,
};

/// Curves that steps of assembled scenes may take: straight ones, those of one [`Frequency`], and those of the frequencies that a scene gives.
#[diagnostic::on_unimplemented(
    message = "an assembled scene has no steps on curves of `{Self}`",
    label = "one frequency for all coordinates, `.frequency(..)`, or those of the scene, `.scene_frequencies()`",
    note = "references and weights fitted to a frequency are for scenes whose sizes are numbers"
)]
pub trait AssembledCurves {
    /// The frequency of every coordinate; none for straight lines.
    ///
    /// # Errors
    /// [`AssemblyError::NoFrequencies`] where the scene was to give them.
    fn frequencies(&self, scene: &PreparedScene) -> Result<Option<Vec<Frequency>>, AssemblyError>;
}

impl AssembledCurves for Linear {
    fn frequencies(&self, _: &PreparedScene) -> Result<Option<Vec<Frequency>>, AssemblyError> {
        Ok(None)
    }
}

impl AssembledCurves for Frequency {
    fn frequencies(&self, scene: &PreparedScene) -> Result<Option<Vec<Frequency>>, AssemblyError> {
        Ok(Some(vec![*self; scene.assembly.n_coordinates]))
    }
}

impl AssembledCurves for SceneFrequencies {
    fn frequencies(&self, scene: &PreparedScene) -> Result<Option<Vec<Frequency>>, AssemblyError> {
        let frequencies = scene.assembly.frequencies().ok_or(AssemblyError::NoFrequencies)?;
        Ok(Some(frequencies.into_iter().map(Frequency::from).collect()))
    }
}

/// The coefficients of all coordinates, node by node.
pub(super) struct Curves(Vec<Vec<NodeCoefficients>>);

impl Curves {
    /// The curves at the nodes of a rule; none where all are straight. `name` calls a coordinate.
    ///
    /// # Errors
    /// [`AssemblyError`] for frequencies that define no step, or of coordinates that nothing holds.
    pub(super) fn new<const K: usize>(
        frequencies: Option<Vec<Frequency>>,
        (rule, h): (&Quadrature<K>, f64),
        scene: &PreparedScene,
        allows_soft_modes: bool,
    ) -> Result<Option<Self>, AssemblyError> {
        let Some(frequencies) = frequencies else { return Ok(None) };
        let is_free = scene.assembly.free_coordinates();
        let mut nodes = vec![Vec::with_capacity(frequencies.len()); K];
        for (coordinate, &frequency) in frequencies.iter().enumerate() {
            let coefficients = checked_coefficients(frequency, coordinate, rule, h)?;
            nodes.iter_mut().zip(coefficients).for_each(|(node, of_coordinate)| node.push(of_coordinate));
            // The frequency itself has been judged.
            if is_free[coordinate] && frequency.value() != 0.0 && !allows_soft_modes {
                let growth_rate = growth_rate(frequency, rule, h, 0.0);
                if growth_rate > 0.0 {
                    let frequency = frequency.value();
                    return Err(AssemblyError::SoftCoordinate { coordinate, frequency, growth_rate });
                }
            }
        }
        // Exactly: without curvature a curve is a line.
        let is_straight = frequencies.iter().all(|frequency| frequency.value() == 0.0);
        Ok((!is_straight).then_some(Self(nodes)))
    }

    /// The coefficients of all coordinates at a node.
    pub(super) fn at(&self, node: usize) -> &[NodeCoefficients] {
        &self.0[node]
    }

    /// Calls `see` for the numbers that tell these curves from others.
    pub(super) fn for_each_number(&self, mut see: impl FnMut(f64)) {
        for coefficients in self.0.iter().flatten() {
            see(coefficients.even);
            see(coefficients.odd_rate);
        }
    }
}
