// operations               + -   *   / f()
// constants                  0   3   0   0
// lagrangian                 5   8   0   1
// lagrangian_gradient        3  10   1   1
// lagrangian_derivatives     8  25   1   1
// constraints                0   0   0   0
// constraint_slopes          0   0   0   0
// constraint_curvature       0   0   0   0
// squared_distance           1   2   0   0
// central_force              1   1   0   0

const _: () = {
    #[automatically_derived]
    #[allow(unused_variables, unused_parens, trivial_numeric_casts, clippy::all)]
    impl ::evi_core::__private::MechanicalSystem for StiffSpringPendulum {
        const COORDINATES: &'static [&'static str] = &["x", "y"];
        const CONSTRAINTS: &'static [&'static str] = &[];
        const PARAMETERS: &'static [&'static str] = &["m", "l", "k", "g"];
        const STRUCTURE: ::evi_core::__private::Structure = ::evi_core::__private::Structure {
            hessian: ::evi_core::__private::HessianPattern {
                qq: &[
                    ::evi_core::__private::Entry {
                        row: 0usize,
                        col: 0usize,
                        value: ::evi_core::__private::EntryValue::Varying(0usize),
                    },
                    ::evi_core::__private::Entry {
                        row: 1usize,
                        col: 0usize,
                        value: ::evi_core::__private::EntryValue::Varying(1usize),
                    },
                    ::evi_core::__private::Entry {
                        row: 1usize,
                        col: 1usize,
                        value: ::evi_core::__private::EntryValue::Varying(2usize),
                    },
                ],
                vq: &[],
                vv: &[
                    ::evi_core::__private::Entry {
                        row: 0usize,
                        col: 0usize,
                        value: ::evi_core::__private::EntryValue::Constant(0usize),
                    },
                    ::evi_core::__private::Entry {
                        row: 1usize,
                        col: 1usize,
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
            central_force: ::core::option::Option::Some(::evi_core::__private::CentralForce {
                is_linear: true,
                is_beside_uniform_force: true,
            }),
            operations: ::evi_core::__private::KernelOperations {
                constants: ::evi_core::__private::Operations {
                    additions: 0usize,
                    multiplications: 3usize,
                    divisions: 0usize,
                    functions: 0usize,
                },
                lagrangian: ::evi_core::__private::Operations {
                    additions: 5usize,
                    multiplications: 8usize,
                    divisions: 0usize,
                    functions: 1usize,
                },
                lagrangian_gradient: ::evi_core::__private::Operations {
                    additions: 3usize,
                    multiplications: 10usize,
                    divisions: 1usize,
                    functions: 1usize,
                },
                lagrangian_derivatives: ::evi_core::__private::Operations {
                    additions: 8usize,
                    multiplications: 25usize,
                    divisions: 1usize,
                    functions: 1usize,
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
            name: "StiffSpringPendulum",
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
                        unicode: "½ m (ẋ² + ẏ²)",
                        latex: "\\frac{1}{2} m (\\dot{x}^2 + \\dot{y}^2)",
                    },
                },
                ::evi_core::__private::Equation {
                    name: "",
                    left: ::evi_core::__private::Formula {
                        unicode: "V",
                        latex: "V",
                    },
                    right: ::evi_core::__private::Formula {
                        unicode: "½ k stretch² + m g y",
                        latex: "\\frac{1}{2} k \\mathrm{stretch}^2 + m g y",
                    },
                },
                ::evi_core::__private::Equation {
                    name: "",
                    left: ::evi_core::__private::Formula {
                        unicode: "stretch",
                        latex: "\\mathrm{stretch}",
                    },
                    right: ::evi_core::__private::Formula {
                        unicode: "√(x² + y²) − l",
                        latex: "\\sqrt{x^2 + y^2} - l",
                    },
                },
            ],
            structure: Self::STRUCTURE,
            kernels: &[
                ::evi_core::__private::KernelReport {
                    name: "constants",
                    operations: ::evi_core::__private::Operations {
                        additions: 0usize,
                        multiplications: 3usize,
                        divisions: 0usize,
                        functions: 0usize,
                    },
                    temporaries: 0usize,
                    statements: 4usize,
                },
                ::evi_core::__private::KernelReport {
                    name: "lagrangian",
                    operations: ::evi_core::__private::Operations {
                        additions: 5usize,
                        multiplications: 8usize,
                        divisions: 0usize,
                        functions: 1usize,
                    },
                    temporaries: 1usize,
                    statements: 2usize,
                },
                ::evi_core::__private::KernelReport {
                    name: "lagrangian_gradient",
                    operations: ::evi_core::__private::Operations {
                        additions: 3usize,
                        multiplications: 10usize,
                        divisions: 1usize,
                        functions: 1usize,
                    },
                    temporaries: 3usize,
                    statements: 7usize,
                },
                ::evi_core::__private::KernelReport {
                    name: "lagrangian_derivatives",
                    operations: ::evi_core::__private::Operations {
                        additions: 8usize,
                        multiplications: 25usize,
                        divisions: 1usize,
                        functions: 1usize,
                    },
                    temporaries: 7usize,
                    statements: 14usize,
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
                ::evi_core::__private::KernelReport {
                    name: "squared_distance",
                    operations: ::evi_core::__private::Operations {
                        additions: 1usize,
                        multiplications: 2usize,
                        divisions: 0usize,
                        functions: 0usize,
                    },
                    temporaries: 0usize,
                    statements: 1usize,
                },
                ::evi_core::__private::KernelReport {
                    name: "central_force",
                    operations: ::evi_core::__private::Operations {
                        additions: 1usize,
                        multiplications: 1usize,
                        divisions: 0usize,
                        functions: 0usize,
                    },
                    temporaries: 0usize,
                    statements: 1usize,
                },
            ],
        };
        type PerCoordinate<X: ::core::clone::Clone> = [X; 2usize];
        type PerConstraint<X: ::core::clone::Clone> = [X; 0usize];
        type PerUnknown<X: ::core::clone::Clone> = [X; 2usize];
        type PerParameter<X: ::core::clone::Clone> = [X; 4usize];
        type PerConstant<X: ::core::clone::Clone> = [X; 7usize];
        type PerHessianEntry<X: ::core::clone::Clone> = [X; 3usize];
        type PerJacobianEntry<X: ::core::clone::Clone> = [X; 0usize];
        type PerInput<X: ::core::clone::Clone> = [X; 0usize];
        type PerObservable<X: ::core::clone::Clone> = [X; 0usize];
        type PerForceEntry<X: ::core::clone::Clone> = [X; 0usize];
        type DenseKktFactors = ::evi_core::__private::DenseLu<2usize>;
        type KktFactors = ::evi_core::__private::Inverse2;
        type MassFactors = ::evi_core::__private::Inverse2;
        type GramFactors = ::evi_core::__private::Inverse0;
        #[inline]
        fn parameters(&self) -> Self::PerParameter<f64> {
            [self.m, self.l, self.k, self.g]
        }
        #[inline]
        fn constants<T: ::evi_core::__private::Scalar>(
            p: &Self::PerParameter<T>,
        ) -> Self::PerConstant<T> {
            let x0 = T::from_f64(0.5) * p[0usize];
            let x1 = T::from_f64(0.5) * p[2usize];
            let x2 = p[0usize] * p[3usize];
            let x3 = -x2;
            [p[0usize], p[1usize], x0, x1, x2, p[2usize], x3]
        }
        #[inline]
        fn lagrangian<T: ::evi_core::__private::Scalar>(
            c: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
            v: &Self::PerCoordinate<T>,
        ) -> T {
            let x0 = (((q[0usize] * q[0usize]) + (q[1usize] * q[1usize])).sqrt())
                - c[1usize];
            let x1 = (c[2usize] * ((v[0usize] * v[0usize]) + (v[1usize] * v[1usize])))
                - ((q[1usize] * c[4usize]) + (c[3usize] * (x0 * x0)));
            x1
        }
        #[inline(always)]
        fn lagrangian_gradient<T: ::evi_core::__private::Scalar>(
            c: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
            v: &Self::PerCoordinate<T>,
        ) -> ::evi_core::__private::LagrangianGradient<Self, T> {
            let x0 = ((q[0usize] * q[0usize]) + (q[1usize] * q[1usize])).sqrt();
            let x1 = x0 - c[1usize];
            let x2 = T::from_f64(1.0) / x0;
            let x3 = -(c[5usize] * (x1 * (q[0usize] * x2)));
            let x4 = -(c[4usize] + (c[5usize] * (x1 * (q[1usize] * x2))));
            let x5 = c[0usize] * v[0usize];
            let x6 = c[0usize] * v[1usize];
            ::evi_core::__private::LagrangianGradient {
                force: [x3, x4],
                momentum: [x5, x6],
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
            let x0 = ((q[0usize] * q[0usize]) + (q[1usize] * q[1usize])).sqrt();
            let x1 = x0 - c[1usize];
            let x2 = T::from_f64(1.0) / x0;
            let x3 = q[0usize] * x2;
            let x4 = -(c[5usize] * (x1 * x3));
            let x5 = q[1usize] * x2;
            let x6 = -(c[4usize] + (c[5usize] * (x1 * x5)));
            let x7 = c[0usize] * v[0usize];
            let x8 = c[0usize] * v[1usize];
            let x9 = x2 * x2;
            let x10 = x3 * x9;
            let x11 = -(c[5usize] * ((x3 * x3) + (x1 * (x2 - (q[0usize] * x10)))));
            let x12 = -(c[5usize] * ((x3 * x5) - (x1 * (q[1usize] * x10))));
            let x13 = -(c[5usize] * ((x5 * x5) + (x1 * (x2 - (q[1usize] * (x5 * x9))))));
            (
                ::evi_core::__private::LagrangianGradient {
                    force: [x4, x6],
                    momentum: [x7, x8],
                },
                [x11, x12, x13],
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
        fn squared_distance<T: ::evi_core::__private::Scalar>(
            c: &Self::PerConstant<T>,
            q: &Self::PerCoordinate<T>,
        ) -> (T, Self::PerCoordinate<T>) {
            let x0 = (q[0usize] * q[0usize]) + (q[1usize] * q[1usize]);
            (x0, [q[0usize], q[1usize]])
        }
        #[inline(always)]
        fn central_force<T: ::evi_core::__private::Scalar>(
            c: &Self::PerConstant<T>,
            r: T,
        ) -> [T; 2] {
            let x0 = c[5usize] * (r - c[1usize]);
            [x0, c[5usize]]
        }
        #[inline]
        fn distance_metric<T: ::evi_core::__private::Scalar>(
            c: &Self::PerConstant<T>,
        ) -> Self::PerCoordinate<Self::PerCoordinate<T>> {
            [[T::from_f64(1.0), T::from_f64(0.0)], [T::from_f64(0.0), T::from_f64(1.0)]]
        }
        #[inline]
        fn uniform_force<T: ::evi_core::__private::Scalar>(
            c: &Self::PerConstant<T>,
        ) -> Self::PerCoordinate<T> {
            [T::from_f64(0.0), c[6usize]]
        }
        #[inline(always)]
        fn for_each_vv<T: ::core::marker::Copy>(
            c: &Self::PerConstant<T>,
            h: &Self::PerHessianEntry<T>,
            mut visit: impl ::core::ops::FnMut(usize, usize, T),
        ) {
            visit(0usize, 0usize, c[0usize]);
            visit(1usize, 1usize, c[0usize]);
        }
        #[inline(always)]
        fn for_each_qq<T: ::core::marker::Copy>(
            c: &Self::PerConstant<T>,
            h: &Self::PerHessianEntry<T>,
            mut visit: impl ::core::ops::FnMut(usize, usize, T),
        ) {
            visit(0usize, 0usize, h[0usize]);
            visit(1usize, 0usize, h[1usize]);
            visit(0usize, 1usize, h[1usize]);
            visit(1usize, 1usize, h[2usize]);
        }
    }
    #[automatically_derived]
    #[allow(unused, non_snake_case, trivial_numeric_casts, clippy::all)]
    impl ::evi_core::__private::GenericSystem for StiffSpringPendulum {
        fn n_coordinates(&self) -> usize {
            2usize
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
            let __name_k = T::from_f64(self.k);
            let __name_g = T::from_f64(self.g);
            let __name_x = __q[0usize];
            let __name_y = __q[1usize];
            let __der_x = __v[0usize];
            let __der_y = __v[1usize];
            let __name_stretch = (__name_x.powi(2) + __name_y.powi(2)).sqrt() - __name_l;
            (T::from_f64(0.5f64) * __name_m * (__der_x.powi(2) + __der_y.powi(2)))
                - (T::from_f64(0.5f64) * __name_k * __name_stretch.powi(2)
                    + __name_m * __name_g * __name_y)
        }
        fn constraints<T: ::evi_core::__private::Scalar>(
            &self,
            t: T,
            __q: &[T],
            __residuals: &mut [T],
        ) {
            let __name_m = T::from_f64(self.m);
            let __name_l = T::from_f64(self.l);
            let __name_k = T::from_f64(self.k);
            let __name_g = T::from_f64(self.g);
            let __name_x = __q[0usize];
            let __name_y = __q[1usize];
            let __name_stretch = (__name_x.powi(2) + __name_y.powi(2)).sqrt() - __name_l;
        }
    }
};
