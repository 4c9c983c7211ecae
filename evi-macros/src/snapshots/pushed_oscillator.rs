// operations               + -   *   / f()
// constants                  0   2   1   1
// lagrangian                 2   5   0   0
// lagrangian_gradient        0   3   0   0
// lagrangian_derivatives     0   3   0   0
// constraints                0   0   0   0
// constraint_slopes          0   0   0   0
// constraint_curvature       0   0   0   0
// forces                     1   4   0   1
// force_derivatives          1   4   0   1
// observables                0   2   0   0

const _: () = {
    #[automatically_derived]
    #[allow(unused_variables, unused_parens, trivial_numeric_casts, clippy::all)]
    impl ::evi_core::__private::MechanicalSystem for PushedOscillator {
        const COORDINATES: &'static [&'static str] = &["x", "y"];
        const CONSTRAINTS: &'static [&'static str] = &[];
        const PARAMETERS: &'static [&'static str] = &["m", "k", "c", "a", "w"];
        const INPUTS: &'static [&'static str] = &["push"];
        const OBSERVABLES: &'static [&'static str] = &["power"];
        const STRUCTURE: ::evi_core::__private::Structure = ::evi_core::__private::Structure {
            hessian: ::evi_core::__private::HessianPattern {
                qq: &[
                    ::evi_core::__private::Entry {
                        row: 0usize,
                        col: 0usize,
                        value: ::evi_core::__private::EntryValue::Constant(0usize),
                    },
                ],
                vq: &[],
                vv: &[
                    ::evi_core::__private::Entry {
                        row: 0usize,
                        col: 0usize,
                        value: ::evi_core::__private::EntryValue::Constant(1usize),
                    },
                    ::evi_core::__private::Entry {
                        row: 1usize,
                        col: 1usize,
                        value: ::evi_core::__private::EntryValue::Constant(1usize),
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
                qq: ::evi_core::__private::Block::Constant,
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
            potential: ::evi_core::__private::Potential::Quadratic,
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
            forces: ::evi_core::__private::ForceStructure {
                forced: &[0usize, 1usize],
                q: &[
                    ::evi_core::__private::Entry {
                        row: 1usize,
                        col: 0usize,
                        value: ::evi_core::__private::EntryValue::Varying(0usize),
                    },
                ],
                v: &[
                    ::evi_core::__private::Entry {
                        row: 0usize,
                        col: 0usize,
                        value: ::evi_core::__private::EntryValue::Constant(2usize),
                    },
                ],
                on: ::evi_core::__private::Dependence {
                    on_q: true,
                    on_v: true,
                    on_t: true,
                },
                on_inputs: true,
                values: ::evi_core::__private::Operations {
                    additions: 1usize,
                    multiplications: 4usize,
                    divisions: 0usize,
                    functions: 1usize,
                },
                derivatives: ::evi_core::__private::Operations {
                    additions: 1usize,
                    multiplications: 4usize,
                    divisions: 0usize,
                    functions: 1usize,
                },
            },
            central_force: ::core::option::Option::None,
            operations: ::evi_core::__private::KernelOperations {
                constants: ::evi_core::__private::Operations {
                    additions: 0usize,
                    multiplications: 2usize,
                    divisions: 1usize,
                    functions: 1usize,
                },
                lagrangian: ::evi_core::__private::Operations {
                    additions: 2usize,
                    multiplications: 5usize,
                    divisions: 0usize,
                    functions: 0usize,
                },
                lagrangian_gradient: ::evi_core::__private::Operations {
                    additions: 0usize,
                    multiplications: 3usize,
                    divisions: 0usize,
                    functions: 0usize,
                },
                lagrangian_derivatives: ::evi_core::__private::Operations {
                    additions: 0usize,
                    multiplications: 3usize,
                    divisions: 0usize,
                    functions: 0usize,
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
            name: "PushedOscillator",
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
                        unicode: "½ k x²",
                        latex: "\\frac{1}{2} k x^2",
                    },
                },
                ::evi_core::__private::Equation {
                    name: "",
                    left: ::evi_core::__private::Formula {
                        unicode: "D",
                        latex: "D",
                    },
                    right: ::evi_core::__private::Formula {
                        unicode: "½ c ẋ²",
                        latex: "\\frac{1}{2} c \\dot{x}^2",
                    },
                },
                ::evi_core::__private::Equation {
                    name: "",
                    left: ::evi_core::__private::Formula {
                        unicode: "f_y",
                        latex: "f_{y}",
                    },
                    right: ::evi_core::__private::Formula {
                        unicode: "follow + a cos(w t)",
                        latex: "\\mathrm{follow} + a \\cos(w t)",
                    },
                },
                ::evi_core::__private::Equation {
                    name: "",
                    left: ::evi_core::__private::Formula {
                        unicode: "ω_x",
                        latex: "\\omega_{x}",
                    },
                    right: ::evi_core::__private::Formula {
                        unicode: "√(k/m)",
                        latex: "\\sqrt{\\frac{k}{m}}",
                    },
                },
                ::evi_core::__private::Equation {
                    name: "",
                    left: ::evi_core::__private::Formula {
                        unicode: "power",
                        latex: "\\mathrm{power}",
                    },
                    right: ::evi_core::__private::Formula {
                        unicode: "follow ẏ",
                        latex: "\\mathrm{follow} \\dot{y}",
                    },
                },
                ::evi_core::__private::Equation {
                    name: "",
                    left: ::evi_core::__private::Formula {
                        unicode: "follow",
                        latex: "\\mathrm{follow}",
                    },
                    right: ::evi_core::__private::Formula {
                        unicode: "push x",
                        latex: "\\mathrm{push} x",
                    },
                },
            ],
            structure: Self::STRUCTURE,
            kernels: &[
                ::evi_core::__private::KernelReport {
                    name: "constants",
                    operations: ::evi_core::__private::Operations {
                        additions: 0usize,
                        multiplications: 2usize,
                        divisions: 1usize,
                        functions: 1usize,
                    },
                    temporaries: 0usize,
                    statements: 5usize,
                },
                ::evi_core::__private::KernelReport {
                    name: "lagrangian",
                    operations: ::evi_core::__private::Operations {
                        additions: 2usize,
                        multiplications: 5usize,
                        divisions: 0usize,
                        functions: 0usize,
                    },
                    temporaries: 0usize,
                    statements: 1usize,
                },
                ::evi_core::__private::KernelReport {
                    name: "lagrangian_gradient",
                    operations: ::evi_core::__private::Operations {
                        additions: 0usize,
                        multiplications: 3usize,
                        divisions: 0usize,
                        functions: 0usize,
                    },
                    temporaries: 0usize,
                    statements: 3usize,
                },
                ::evi_core::__private::KernelReport {
                    name: "lagrangian_derivatives",
                    operations: ::evi_core::__private::Operations {
                        additions: 0usize,
                        multiplications: 3usize,
                        divisions: 0usize,
                        functions: 0usize,
                    },
                    temporaries: 0usize,
                    statements: 3usize,
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
                    name: "forces",
                    operations: ::evi_core::__private::Operations {
                        additions: 1usize,
                        multiplications: 4usize,
                        divisions: 0usize,
                        functions: 1usize,
                    },
                    temporaries: 1usize,
                    statements: 3usize,
                },
                ::evi_core::__private::KernelReport {
                    name: "force_derivatives",
                    operations: ::evi_core::__private::Operations {
                        additions: 1usize,
                        multiplications: 4usize,
                        divisions: 0usize,
                        functions: 1usize,
                    },
                    temporaries: 1usize,
                    statements: 3usize,
                },
                ::evi_core::__private::KernelReport {
                    name: "observables",
                    operations: ::evi_core::__private::Operations {
                        additions: 0usize,
                        multiplications: 2usize,
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
        type PerParameter<X: ::core::clone::Clone> = [X; 5usize];
        type PerConstant<X: ::core::clone::Clone> = [X; 10usize];
        type PerHessianEntry<X: ::core::clone::Clone> = [X; 0usize];
        type PerJacobianEntry<X: ::core::clone::Clone> = [X; 0usize];
        type PerInput<X: ::core::clone::Clone> = [X; 1usize];
        type PerObservable<X: ::core::clone::Clone> = [X; 1usize];
        type PerForceEntry<X: ::core::clone::Clone> = [X; 1usize];
        type DenseKktFactors = ::evi_core::__private::DenseLu<2usize>;
        type KktFactors = ::evi_core::__private::Inverse2;
        type MassFactors = ::evi_core::__private::Inverse2;
        type GramFactors = ::evi_core::__private::Inverse0;
        #[inline]
        fn parameters(&self) -> Self::PerParameter<f64> {
            [self.m, self.k, self.c, self.a, self.w]
        }
        #[inline]
        fn constants<T: ::evi_core::__private::Scalar>(
            p: &Self::PerParameter<T>,
        ) -> Self::PerConstant<T> {
            let x0 = T::from_f64(0.5) * p[0usize];
            let x1 = T::from_f64(0.5) * p[1usize];
            let x2 = (p[1usize] / p[0usize]).sqrt();
            let x3 = -p[1usize];
            let x4 = -p[2usize];
            [x3, p[0usize], x4, x0, x1, p[1usize], p[2usize], p[3usize], p[4usize], x2]
        }
        #[inline]
        fn lagrangian<T: ::evi_core::__private::Scalar>(
            c: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
            v: &Self::PerCoordinate<T>,
        ) -> T {
            let x0 = (c[3usize] * ((v[0usize] * v[0usize]) + (v[1usize] * v[1usize])))
                - (c[4usize] * (q[0usize] * q[0usize]));
            x0
        }
        #[inline(always)]
        fn lagrangian_gradient<T: ::evi_core::__private::Scalar>(
            c: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
            v: &Self::PerCoordinate<T>,
        ) -> ::evi_core::__private::LagrangianGradient<Self, T> {
            let x0 = -(c[5usize] * q[0usize]);
            let x1 = c[1usize] * v[0usize];
            let x2 = c[1usize] * v[1usize];
            ::evi_core::__private::LagrangianGradient {
                force: [x0, T::from_f64(0.0)],
                momentum: [x1, x2],
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
            let x0 = -(c[5usize] * q[0usize]);
            let x1 = c[1usize] * v[0usize];
            let x2 = c[1usize] * v[1usize];
            (
                ::evi_core::__private::LagrangianGradient {
                    force: [x0, T::from_f64(0.0)],
                    momentum: [x1, x2],
                },
                [],
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
        fn forces<T: ::evi_core::__private::Scalar>(
            c: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
            v: &Self::PerCoordinate<T>,
            u: &Self::PerInput<T>,
        ) -> Self::PerCoordinate<T> {
            let x0 = (c[8usize] * t).cos();
            let x1 = (q[0usize] * u[0usize]) + (c[7usize] * x0);
            let x2 = -(v[0usize] * c[6usize]);
            [x2, x1]
        }
        #[inline]
        fn force_derivatives<T: ::evi_core::__private::Scalar>(
            c: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
            v: &Self::PerCoordinate<T>,
            u: &Self::PerInput<T>,
        ) -> (Self::PerCoordinate<T>, Self::PerForceEntry<T>) {
            let x0 = (c[8usize] * t).cos();
            let x1 = (q[0usize] * u[0usize]) + (c[7usize] * x0);
            let x2 = -(v[0usize] * c[6usize]);
            ([x2, x1], [u[0usize]])
        }
        #[inline]
        fn observables<T: ::evi_core::__private::Scalar>(
            c: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
            v: &Self::PerCoordinate<T>,
            u: &Self::PerInput<T>,
        ) -> Self::PerObservable<T> {
            let x0 = v[1usize] * (q[0usize] * u[0usize]);
            [x0]
        }
        #[inline(always)]
        fn for_each_vv<T: ::core::marker::Copy>(
            c: &Self::PerConstant<T>,
            h: &Self::PerHessianEntry<T>,
            mut visit: impl ::core::ops::FnMut(usize, usize, T),
        ) {
            visit(0usize, 0usize, c[1usize]);
            visit(1usize, 1usize, c[1usize]);
        }
        #[inline(always)]
        fn for_each_qq<T: ::core::marker::Copy>(
            c: &Self::PerConstant<T>,
            h: &Self::PerHessianEntry<T>,
            mut visit: impl ::core::ops::FnMut(usize, usize, T),
        ) {
            visit(0usize, 0usize, c[0usize]);
        }
    }
    #[automatically_derived]
    #[allow(unused_variables, trivial_numeric_casts, clippy::all)]
    impl ::evi_core::__private::HasFrequencies for PushedOscillator {
        #[inline]
        fn frequencies<T: ::evi_core::__private::Scalar>(
            c: &Self::PerConstant<T>,
        ) -> Self::PerCoordinate<T> {
            [c[9usize], T::from_f64(0.0)]
        }
    }
    #[automatically_derived]
    #[allow(unused, non_snake_case, trivial_numeric_casts, clippy::all)]
    impl ::evi_core::__private::GenericSystem for PushedOscillator {
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
            let __name_k = T::from_f64(self.k);
            let __name_c = T::from_f64(self.c);
            let __name_a = T::from_f64(self.a);
            let __name_w = T::from_f64(self.w);
            let __name_x = __q[0usize];
            let __name_y = __q[1usize];
            let __der_x = __v[0usize];
            let __der_y = __v[1usize];
            (T::from_f64(0.5f64) * __name_m * (__der_x.powi(2) + __der_y.powi(2)))
                - (T::from_f64(0.5f64) * __name_k * __name_x.powi(2))
        }
        fn constraints<T: ::evi_core::__private::Scalar>(
            &self,
            t: T,
            __q: &[T],
            __residuals: &mut [T],
        ) {
            let __name_m = T::from_f64(self.m);
            let __name_k = T::from_f64(self.k);
            let __name_c = T::from_f64(self.c);
            let __name_a = T::from_f64(self.a);
            let __name_w = T::from_f64(self.w);
            let __name_x = __q[0usize];
            let __name_y = __q[1usize];
        }
        fn n_inputs(&self) -> usize {
            1usize
        }
        const HAS_DISSIPATION: bool = true;
        fn dissipation<T: ::evi_core::__private::Scalar>(
            &self,
            t: T,
            __q: &[T],
            __v: &[T],
        ) -> T {
            let __name_m = T::from_f64(self.m);
            let __name_k = T::from_f64(self.k);
            let __name_c = T::from_f64(self.c);
            let __name_a = T::from_f64(self.a);
            let __name_w = T::from_f64(self.w);
            let __name_x = __q[0usize];
            let __name_y = __q[1usize];
            let __der_x = __v[0usize];
            let __der_y = __v[1usize];
            (T::from_f64(0.5f64) * __name_c * __der_x.powi(2))
        }
        const HAS_FORCES: bool = true;
        fn add_forces<T: ::evi_core::__private::Scalar>(
            &self,
            t: T,
            __q: &[T],
            __v: &[T],
            __u: &[T],
            __forces: &mut [T],
        ) {
            let __name_m = T::from_f64(self.m);
            let __name_k = T::from_f64(self.k);
            let __name_c = T::from_f64(self.c);
            let __name_a = T::from_f64(self.a);
            let __name_w = T::from_f64(self.w);
            let __name_x = __q[0usize];
            let __name_y = __q[1usize];
            let __der_x = __v[0usize];
            let __der_y = __v[1usize];
            let __name_push = __u[0usize];
            let __name_follow = __name_push * __name_x;
            __forces[1usize] = __forces[1usize]
                + (__name_follow + __name_a * (__name_w * t).cos());
        }
    }
};
