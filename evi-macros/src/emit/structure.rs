//! `MechanicalSystem::STRUCTURE`: what the analysis has found, as a constant.

use proc_macro2::TokenStream;
use quote::quote;

use super::{central_force, forces};
use crate::expr::Dependence;
use crate::schedule::{Operations, Programs};
use crate::structure::{Block, ConstraintStructure, Entry, EntryValue, MassShape, Potential};

/// The structure and the operation counts.
pub(super) fn structure(programs: &Programs) -> TokenStream {
    let known = &programs.structure;
    let (qq, vq) = (entries(&known.hessian_qq), entries(&known.hessian_vq));
    let (vv, vt) = (entries(&known.hessian_vv), entries(&known.hessian_vt));
    let (jacobian_q, jacobian_t) = (entries(&known.jacobian_q), entries(&known.jacobian_t));
    let content = known.content;
    let classification = &known.classification;
    let (block_qq, block_vq) = (block(classification.qq), block(classification.vq));
    let (block_vv, block_vt) = (block(classification.vv), block(classification.vt));
    let (mass_shape, potential) =
        (mass_shape(classification.mass_shape), potential(classification.potential));
    let momentum_vanishes_at_rest = classification.momentum_vanishes_at_rest;
    let each_constraint = classification.each_constraint.iter().map(constraint_structure);
    let constraint_graph =
        classification.constraint_graph.iter().map(|(first, second)| quote!((#first, #second)));
    let (mass, lagrangian) = (dependence(known.mass), dependence(known.lagrangian));
    let constraint_dependence = dependence(known.constraints);
    let forces = forces::structure(programs);
    let central_force = central_force::structure(programs);
    let constants = operations(programs.constants.operations);
    let lagrangian_operations = operations(programs.lagrangian.operations);
    let lagrangian_gradient = operations(programs.lagrangian_gradient.operations);
    let lagrangian_derivatives = operations(programs.lagrangian_derivatives.operations);
    let constraints = operations(programs.constraints.operations);
    let constraint_slopes = operations(programs.constraint_slopes.operations);
    let constraint_curvature = operations(programs.constraint_curvature.operations);
    quote! {
        const STRUCTURE: ::evi_core::__private::Structure = ::evi_core::__private::Structure {
            hessian: ::evi_core::__private::HessianPattern { qq: #qq, vq: #vq, vv: #vv, vt: #vt },
            jacobian: ::evi_core::__private::JacobianPattern { q: #jacobian_q, t: #jacobian_t, content: #content },
            blocks: ::evi_core::__private::HessianBlocks {
                qq: #block_qq,
                vq: #block_vq,
                vv: #block_vv,
                vt: #block_vt,
            },
            mass: #mass,
            mass_shape: #mass_shape,
            potential: #potential,
            momentum_vanishes_at_rest: #momentum_vanishes_at_rest,
            lagrangian: #lagrangian,
            constraints: #constraint_dependence,
            each_constraint: &[#(#each_constraint),*],
            constraint_graph: &[#(#constraint_graph),*],
            forces: #forces,
            central_force: #central_force,
            operations: ::evi_core::__private::KernelOperations {
                constants: #constants,
                lagrangian: #lagrangian_operations,
                lagrangian_gradient: #lagrangian_gradient,
                lagrangian_derivatives: #lagrangian_derivatives,
                constraints: #constraints,
                constraint_slopes: #constraint_slopes,
                constraint_curvature: #constraint_curvature,
            },
        };
    }
}

pub(super) fn entries(entries: &[Entry]) -> TokenStream {
    let entries = entries.iter().map(|&Entry { row, col, value }| {
        let value = match value {
            EntryValue::Constant(slot) => quote!(Constant(#slot)),
            EntryValue::Varying(index) => quote!(Varying(#index)),
        };
        quote!(::evi_core::__private::Entry { row: #row, col: #col, value: ::evi_core::__private::EntryValue::#value })
    });
    quote!(&[#(#entries),*])
}

pub(super) fn dependence(Dependence { on_q, on_v, on_t, .. }: Dependence) -> TokenStream {
    quote!(::evi_core::__private::Dependence { on_q: #on_q, on_v: #on_v, on_t: #on_t })
}

fn block(block: Block) -> TokenStream {
    let block = match block {
        Block::Zero => quote!(Zero),
        Block::Constant => quote!(Constant),
        Block::Varying(on) => {
            let on = dependence(on);
            quote!(Varying(#on))
        }
    };
    quote!(::evi_core::__private::Block::#block)
}

fn mass_shape(shape: MassShape) -> TokenStream {
    let shape = match shape {
        MassShape::Diagonal => quote!(Diagonal),
        MassShape::BlockDiagonal(blocks) => quote!(BlockDiagonal(#blocks)),
        MassShape::Full => quote!(Full),
    };
    quote!(::evi_core::__private::MassShape::#shape)
}

fn potential(potential: Potential) -> TokenStream {
    let potential = match potential {
        Potential::Zero => quote!(Zero),
        Potential::Affine => quote!(Affine),
        Potential::Quadratic => quote!(Quadratic),
        Potential::General => quote!(General),
        Potential::Inseparable => quote!(Inseparable),
    };
    quote!(::evi_core::__private::Potential::#potential)
}

fn constraint_structure(constraint: &ConstraintStructure) -> TokenStream {
    let ConstraintStructure { on_t, is_quadratic, is_sphere, .. } = *constraint;
    let gradient = block(constraint.gradient);
    let repeats = match constraint.repeats {
        Some(earlier) => quote!(::core::option::Option::Some(#earlier)),
        None => quote!(::core::option::Option::None),
    };
    quote!(::evi_core::__private::ConstraintStructure {
        gradient: #gradient,
        on_t: #on_t,
        is_quadratic: #is_quadratic,
        is_sphere: #is_sphere,
        repeats: #repeats,
    })
}

pub(super) fn operations(operations: Operations) -> TokenStream {
    let Operations { additions, multiplications, divisions, functions } = operations;
    quote!(::evi_core::__private::Operations {
        additions: #additions,
        multiplications: #multiplications,
        divisions: #divisions,
        functions: #functions,
    })
}
