// operations               + -   *   / f()
// constants                  0   5   0   0
// lagrangian                 1   3   0   1
// lagrangian_gradient        0   2   0   1
// lagrangian_derivatives     0   3   0   2
// constraints                0   0   0   0
// constraint_slopes          0   0   0   0
// constraint_curvature       0   0   0   0

const _: () = {
    #[automatically_derived]
    #[allow(unused_variables, unused_parens, trivial_numeric_casts, clippy::all)]
    impl ::evi_core::__private::MechanicalSystem for Pendulum {
        const COORDINATES: &'static [&'static str] = &["theta"];
        const CONSTRAINTS: &'static [&'static str] = &[];
        const PARAMETERS: &'static [&'static str] = &["m", "l", "g"];
        const STRUCTURE: ::evi_core::__private::Structure = ::evi_core::__private::Structure {
            hessian: ::evi_core::__private::HessianPattern {
                qq: &[
                    ::evi_core::__private::Entry {
                        row: 0usize,
                        col: 0usize,
                        value: ::evi_core::__private::EntryValue::Varying(0usize),
                    },
                ],
                vq: &[],
                vv: &[
                    ::evi_core::__private::Entry {
                        row: 0usize,
                        col: 0usize,
                        value: ::evi_core::__private::EntryValue::Constant(0usize),
                    },
                ],
                vt: &[],
            },
            jacobian: ::evi_core::__private::JacobianPattern {
                q: &[],
                t: &[],
                content: 1f64,
            },
            blocks: ::evi_core::__private::HessianBlocks {
                qq: ::evi_core::__private::Block::Varying(::evi_core::__private::Dependence {
                    on_q: true,
                    on_v: false,
                    on_t: false,
                }),
                vq: ::evi_core::__private::Block::Zero,
                vv: ::evi_core::__private::Block::Constant,
                vt: ::evi_core::__private::Block::Zero,
            },
            mass: ::evi_core::__private::Dependence {
                on_q: false,
                on_v: false,
                on_t: false,
            },
            mass_shape: ::evi_core::__private::MassShape::Diagonal,
            potential: ::evi_core::__private::Potential::General,
            momentum_vanishes_at_rest: true,
            lagrangian: ::evi_core::__private::Dependence {
                on_q: true,
                on_v: true,
                on_t: false,
            },
            constraints: ::evi_core::__private::Dependence {
                on_q: false,
                on_v: false,
                on_t: false,
            },
            each_constraint: &[],
            constraint_graph: &[],
            forces: ::evi_core::__private::ForceStructure::NONE,
            central_force: ::core::option::Option::None,
            operations: ::evi_core::__private::KernelOperations {
                constants: ::evi_core::__private::Operations {
                    additions: 0usize,
                    multiplications: 5usize,
                    divisions: 0usize,
                    functions: 0usize,
                },
                lagrangian: ::evi_core::__private::Operations {
                    additions: 1usize,
                    multiplications: 3usize,
                    divisions: 0usize,
                    functions: 1usize,
                },
                lagrangian_gradient: ::evi_core::__private::Operations {
                    additions: 0usize,
                    multiplications: 2usize,
                    divisions: 0usize,
                    functions: 1usize,
                },
                lagrangian_derivatives: ::evi_core::__private::Operations {
                    additions: 0usize,
                    multiplications: 3usize,
                    divisions: 0usize,
                    functions: 2usize,
                },
                constraints: ::evi_core::__private::Operations {
                    additions: 0usize,
                    multiplications: 0usize,
                    divisions: 0usize,
                    functions: 0usize,
                },
                constraint_slopes: ::evi_core::__private::Operations {
                    additions: 0usize,
                    multiplications: 0usize,
                    divisions: 0usize,
                    functions: 0usize,
                },
                constraint_curvature: ::evi_core::__private::Operations {
                    additions: 0usize,
                    multiplications: 0usize,
                    divisions: 0usize,
                    functions: 0usize,
                },
            },
        };
        const REPORT: ::evi_core::__private::SystemReport = ::evi_core::__private::SystemReport {
            name: "Pendulum",
            coordinates: Self::COORDINATES,
            constraints: Self::CONSTRAINTS,
            parameters: Self::PARAMETERS,
            inputs: Self::INPUTS,
            observables: Self::OBSERVABLES,
            equations: &[
                ::evi_core::__private::Equation {
                    name: "",
                    left: ::evi_core::__private::Formula {
                        unicode: "L",
                        latex: "L",
                    },
                    right: ::evi_core::__private::Formula {
                        unicode: "T − V",
                        latex: "T - V",
                    },
                },
                ::evi_core::__private::Equation {
                    name: "",
                    left: ::evi_core::__private::Formula {
                        unicode: "T",
                        latex: "T",
                    },
                    right: ::evi_core::__private::Formula {
                        unicode: "½ m l² θ\u{307}²",
                        latex: "\\frac{1}{2} m l^2 \\dot{\\theta}^2",
                    },
                },
                ::evi_core::__private::Equation {
                    name: "",
                    left: ::evi_core::__private::Formula {
                        unicode: "V",
                        latex: "V",
                    },
                    right: ::evi_core::__private::Formula {
                        unicode: "−m g l cos θ",
                        latex: "-m g l \\cos \\theta",
                    },
                },
            ],
            structure: Self::STRUCTURE,
            kernels: &[
                ::evi_core::__private::KernelReport {
                    name: "constants",
                    operations: ::evi_core::__private::Operations {
                        additions: 0usize,
                        multiplications: 5usize,
                        divisions: 0usize,
                        functions: 0usize,
                    },
                    temporaries: 0usize,
                    statements: 3usize,
                },
                ::evi_core::__private::KernelReport {
                    name: "lagrangian",
                    operations: ::evi_core::__private::Operations {
                        additions: 1usize,
                        multiplications: 3usize,
                        divisions: 0usize,
                        functions: 1usize,
                    },
                    temporaries: 1usize,
                    statements: 2usize,
                },
                ::evi_core::__private::KernelReport {
                    name: "lagrangian_gradient",
                    operations: ::evi_core::__private::Operations {
                        additions: 0usize,
                        multiplications: 2usize,
                        divisions: 0usize,
                        functions: 1usize,
                    },
                    temporaries: 1usize,
                    statements: 3usize,
                },
                ::evi_core::__private::KernelReport {
                    name: "lagrangian_derivatives",
                    operations: ::evi_core::__private::Operations {
                        additions: 0usize,
                        multiplications: 3usize,
                        divisions: 0usize,
                        functions: 2usize,
                    },
                    temporaries: 2usize,
                    statements: 4usize,
                },
                ::evi_core::__private::KernelReport {
                    name: "constraints",
                    operations: ::evi_core::__private::Operations {
                        additions: 0usize,
                        multiplications: 0usize,
                        divisions: 0usize,
                        functions: 0usize,
                    },
                    temporaries: 0usize,
                    statements: 0usize,
                },
                ::evi_core::__private::KernelReport {
                    name: "constraint_slopes",
                    operations: ::evi_core::__private::Operations {
                        additions: 0usize,
                        multiplications: 0usize,
                        divisions: 0usize,
                        functions: 0usize,
                    },
                    temporaries: 0usize,
                    statements: 0usize,
                },
                ::evi_core::__private::KernelReport {
                    name: "constraint_curvature",
                    operations: ::evi_core::__private::Operations {
                        additions: 0usize,
                        multiplications: 0usize,
                        divisions: 0usize,
                        functions: 0usize,
                    },
                    temporaries: 0usize,
                    statements: 0usize,
                },
            ],
        };
        type PerCoordinate<X: ::core::clone::Clone> = [X; 1usize];
        type PerConstraint<X: ::core::clone::Clone> = [X; 0usize];
        type PerUnknown<X: ::core::clone::Clone> = [X; 1usize];
        type PerParameter<X: ::core::clone::Clone> = [X; 3usize];
        type PerConstant<X: ::core::clone::Clone> = [X; 3usize];
        type PerHessianEntry<X: ::core::clone::Clone> = [X; 1usize];
        type PerJacobianEntry<X: ::core::clone::Clone> = [X; 0usize];
        type PerInput<X: ::core::clone::Clone> = [X; 0usize];
        type PerObservable<X: ::core::clone::Clone> = [X; 0usize];
        type PerForceEntry<X: ::core::clone::Clone> = [X; 0usize];
        type DenseKktFactors = ::evi_core::__private::DenseLu<1usize>;
        type KktFactors = ::evi_core::__private::Inverse1;
        type MassFactors = ::evi_core::__private::Inverse1;
        type GramFactors = ::evi_core::__private::Inverse0;
        #[inline]
        fn parameters(&self) -> Self::PerParameter<f64> {
            [self.m, self.l, self.g]
        }
        #[inline]
        fn constants<T: ::evi_core::__private::Scalar>(
            p: &Self::PerParameter<T>,
        ) -> Self::PerConstant<T> {
            let x0 = p[0usize] * (p[1usize] * p[1usize]);
            let x1 = T::from_f64(0.5) * x0;
            let x2 = p[1usize] * (p[0usize] * p[2usize]);
            [x0, x1, x2]
        }
        #[inline]
        fn lagrangian<T: ::evi_core::__private::Scalar>(
            c: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
            v: &Self::PerCoordinate<T>,
        ) -> T {
            let x0 = q[0usize].cos();
            let x1 = (c[1usize] * (v[0usize] * v[0usize])) + (x0 * c[2usize]);
            x1
        }
        #[inline(always)]
        fn lagrangian_gradient<T: ::evi_core::__private::Scalar>(
            c: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
            v: &Self::PerCoordinate<T>,
        ) -> ::evi_core::__private::LagrangianGradient<Self, T> {
            let x0 = q[0usize].sin();
            let x1 = -(c[2usize] * x0);
            let x2 = v[0usize] * c[0usize];
            ::evi_core::__private::LagrangianGradient {
                force: [x1],
                momentum: [x2],
            }
        }
        #[inline(always)]
        fn lagrangian_derivatives<T: ::evi_core::__private::Scalar>(
            c: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
            v: &Self::PerCoordinate<T>,
        ) -> (
            ::evi_core::__private::LagrangianGradient<Self, T>,
            Self::PerHessianEntry<T>,
        ) {
            let (x0, x1) = q[0usize].sin_cos();
            let x2 = -(x1 * c[2usize]);
            let x3 = -(c[2usize] * x0);
            let x4 = v[0usize] * c[0usize];
            (
                ::evi_core::__private::LagrangianGradient {
                    force: [x3],
                    momentum: [x4],
                },
                [x2],
            )
        }
        #[inline(always)]
        fn constraints<T: ::evi_core::__private::Scalar>(
            c: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
        ) -> Self::PerConstraint<T> {
            []
        }
        #[inline(always)]
        fn constraint_slopes<T: ::evi_core::__private::Scalar>(
            c: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
        ) -> (Self::PerConstraint<T>, Self::PerJacobianEntry<T>) {
            ([], [])
        }
        #[inline]
        fn constraint_curvature<T: ::evi_core::__private::Scalar>(
            c: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
            v: &Self::PerCoordinate<T>,
        ) -> Self::PerConstraint<T> {
            []
        }
        #[inline(always)]
        fn for_each_vv<T: ::core::marker::Copy>(
            c: &Self::PerConstant<T>,
            h: &Self::PerHessianEntry<T>,
            mut visit: impl ::core::ops::FnMut(usize, usize, T),
        ) {
            visit(0usize, 0usize, c[0usize]);
        }
        #[inline(always)]
        fn for_each_qq<T: ::core::marker::Copy>(
            c: &Self::PerConstant<T>,
            h: &Self::PerHessianEntry<T>,
            mut visit: impl ::core::ops::FnMut(usize, usize, T),
        ) {
            visit(0usize, 0usize, h[0usize]);
        }
    }
    #[automatically_derived]
    #[allow(unused, non_snake_case, trivial_numeric_casts, clippy::all)]
    impl ::evi_core::__private::GenericSystem for Pendulum {
        fn n_coordinates(&self) -> usize {
            1usize
        }
        fn n_constraints(&self) -> usize {
            0usize
        }
        fn lagrangian<T: ::evi_core::__private::Scalar>(
            &self,
            t: T,
            __q: &[T],
            __v: &[T],
        ) -> T {
            let __name_m = T::from_f64(self.m);
            let __name_l = T::from_f64(self.l);
            let __name_g = T::from_f64(self.g);
            let __name_theta = __q[0usize];
            let __der_theta = __v[0usize];
            (T::from_f64(0.5f64) * __name_m * __name_l.powi(2) * __der_theta.powi(2))
                - (-__name_m * __name_g * __name_l * __name_theta.cos())
        }
        fn constraints<T: ::evi_core::__private::Scalar>(
            &self,
            t: T,
            __q: &[T],
            __residuals: &mut [T],
        ) {
            let __name_m = T::from_f64(self.m);
            let __name_l = T::from_f64(self.l);
            let __name_g = T::from_f64(self.g);
            let __name_theta = __q[0usize];
        }
    }
};
