// operations               + -   *   / f()
// constants                  0   3   0   0
// lagrangian                 3   5   0   0
// lagrangian_gradient        0   3   0   0
// lagrangian_derivatives     0   3   0   0
// constraints                3   3   0   0
// constraint_slopes          3   3   0   0
// constraint_curvature       2   6   0   0

const _: () = {
    #[doc(hidden)]
    pub struct KktElimination {
        e: [f64; 10usize],
    }
    #[automatically_derived]
    #[allow(clippy::all)]
    impl ::evi_core::__private::Elimination<4usize> for KktElimination {
        #[inline]
        fn factor(m: &[[f64; 4usize]; 4usize]) -> ::core::option::Option<Self> {
            let mut e = [0.0_f64; 10usize];
            let mut s = [0.0_f64; 4usize];
            e[0usize] = m[0usize][0usize];
            e[2usize] = m[0usize][3usize];
            e[3usize] = m[1usize][1usize];
            e[5usize] = m[1usize][3usize];
            e[6usize] = m[2usize][2usize];
            e[8usize] = m[2usize][3usize];
            e[1usize] = m[3usize][0usize];
            e[4usize] = m[3usize][1usize];
            e[7usize] = m[3usize][2usize];
            s[0usize] = e[0usize].abs();
            s[1usize] = e[3usize].abs();
            s[2usize] = e[6usize].abs();
            e[0usize] = ::evi_core::__private::reciprocal_pivot(e[0usize], s[0usize])?;
            e[1usize] *= e[0usize];
            {
                let update = e[1usize] * e[2usize];
                e[9usize] -= update;
                s[3usize] += update.abs();
            }
            e[3usize] = ::evi_core::__private::reciprocal_pivot(e[3usize], s[1usize])?;
            e[4usize] *= e[3usize];
            {
                let update = e[4usize] * e[5usize];
                e[9usize] -= update;
                s[3usize] += update.abs();
            }
            e[6usize] = ::evi_core::__private::reciprocal_pivot(e[6usize], s[2usize])?;
            e[7usize] *= e[6usize];
            {
                let update = e[7usize] * e[8usize];
                e[9usize] -= update;
                s[3usize] += update.abs();
            }
            e[9usize] = ::evi_core::__private::reciprocal_pivot(e[9usize], s[3usize])?;
            ::core::option::Option::Some(Self { e })
        }
        #[inline]
        fn solve(&self, b: &mut [f64; 4usize]) {
            let e = &self.e;
            b[3usize] -= e[1usize] * b[0usize];
            b[3usize] -= e[4usize] * b[1usize];
            b[3usize] -= e[7usize] * b[2usize];
            b[3usize] = (b[3usize]) * e[9usize];
            b[2usize] = (b[2usize] - e[8usize] * b[3usize]) * e[6usize];
            b[1usize] = (b[1usize] - e[5usize] * b[3usize]) * e[3usize];
            b[0usize] = (b[0usize] - e[2usize] * b[3usize]) * e[0usize];
        }
    }
    #[doc(hidden)]
    pub struct MassElimination {
        e: [f64; 3usize],
    }
    #[automatically_derived]
    #[allow(clippy::all)]
    impl ::evi_core::__private::Elimination<3usize> for MassElimination {
        #[inline]
        fn factor(m: &[[f64; 3usize]; 3usize]) -> ::core::option::Option<Self> {
            let mut e = [0.0_f64; 3usize];
            let mut s = [0.0_f64; 3usize];
            e[0usize] = m[0usize][0usize];
            e[1usize] = m[1usize][1usize];
            e[2usize] = m[2usize][2usize];
            s[0usize] = e[0usize].abs();
            s[1usize] = e[1usize].abs();
            s[2usize] = e[2usize].abs();
            e[0usize] = ::evi_core::__private::reciprocal_pivot(e[0usize], s[0usize])?;
            e[1usize] = ::evi_core::__private::reciprocal_pivot(e[1usize], s[1usize])?;
            e[2usize] = ::evi_core::__private::reciprocal_pivot(e[2usize], s[2usize])?;
            ::core::option::Option::Some(Self { e })
        }
        #[inline]
        fn solve(&self, b: &mut [f64; 3usize]) {
            let e = &self.e;
            b[2usize] = (b[2usize]) * e[2usize];
            b[1usize] = (b[1usize]) * e[1usize];
            b[0usize] = (b[0usize]) * e[0usize];
        }
    }
    #[automatically_derived]
    #[allow(unused_variables, unused_parens, trivial_numeric_casts, clippy::all)]
    impl ::evi_core::__private::MechanicalSystem for SphericalPendulum {
        const COORDINATES: &'static [&'static str] = &["x", "y", "z"];
        const CONSTRAINTS: &'static [&'static str] = &["rod"];
        const PARAMETERS: &'static [&'static str] = &["m", "l", "g"];
        const STRUCTURE: ::evi_core::__private::Structure = ::evi_core::__private::Structure {
            hessian: ::evi_core::__private::HessianPattern {
                qq: &[],
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
                    ::evi_core::__private::Entry {
                        row: 2usize,
                        col: 2usize,
                        value: ::evi_core::__private::EntryValue::Constant(0usize),
                    },
                ],
                vt: &[],
            },
            jacobian: ::evi_core::__private::JacobianPattern {
                q: &[
                    ::evi_core::__private::Entry {
                        row: 0usize,
                        col: 0usize,
                        value: ::evi_core::__private::EntryValue::Varying(0usize),
                    },
                    ::evi_core::__private::Entry {
                        row: 0usize,
                        col: 1usize,
                        value: ::evi_core::__private::EntryValue::Varying(1usize),
                    },
                    ::evi_core::__private::Entry {
                        row: 0usize,
                        col: 2usize,
                        value: ::evi_core::__private::EntryValue::Varying(2usize),
                    },
                ],
                t: &[],
                content: 2f64,
            },
            blocks: ::evi_core::__private::HessianBlocks {
                qq: ::evi_core::__private::Block::Zero,
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
            potential: ::evi_core::__private::Potential::Affine,
            momentum_vanishes_at_rest: true,
            lagrangian: ::evi_core::__private::Dependence {
                on_q: true,
                on_v: true,
                on_t: false,
            },
            constraints: ::evi_core::__private::Dependence {
                on_q: true,
                on_v: false,
                on_t: false,
            },
            each_constraint: &[
                ::evi_core::__private::ConstraintStructure {
                    gradient: ::evi_core::__private::Block::Varying(::evi_core::__private::Dependence {
                        on_q: true,
                        on_v: false,
                        on_t: false,
                    }),
                    on_t: false,
                    is_quadratic: true,
                    is_sphere: true,
                    repeats: ::core::option::Option::None,
                },
            ],
            constraint_graph: &[],
            forces: ::evi_core::__private::ForceStructure::NONE,
            central_force: ::core::option::Option::None,
            operations: ::evi_core::__private::KernelOperations {
                constants: ::evi_core::__private::Operations {
                    additions: 0usize,
                    multiplications: 3usize,
                    divisions: 0usize,
                    functions: 0usize,
                },
                lagrangian: ::evi_core::__private::Operations {
                    additions: 3usize,
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
                    additions: 3usize,
                    multiplications: 3usize,
                    divisions: 0usize,
                    functions: 0usize,
                },
                constraint_slopes: ::evi_core::__private::Operations {
                    additions: 3usize,
                    multiplications: 3usize,
                    divisions: 0usize,
                    functions: 0usize,
                },
                constraint_curvature: ::evi_core::__private::Operations {
                    additions: 2usize,
                    multiplications: 6usize,
                    divisions: 0usize,
                    functions: 0usize,
                },
            },
        };
        const REPORT: ::evi_core::__private::SystemReport = ::evi_core::__private::SystemReport {
            name: "SphericalPendulum",
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
                        unicode: "½ m (ẋ² + ẏ² + ż²)",
                        latex: "\\frac{1}{2} m (\\dot{x}^2 + \\dot{y}^2 + \\dot{z}^2)",
                    },
                },
                ::evi_core::__private::Equation {
                    name: "",
                    left: ::evi_core::__private::Formula {
                        unicode: "V",
                        latex: "V",
                    },
                    right: ::evi_core::__private::Formula {
                        unicode: "m g z",
                        latex: "m g z",
                    },
                },
                ::evi_core::__private::Equation {
                    name: "rod",
                    left: ::evi_core::__private::Formula {
                        unicode: "x² + y² + z²",
                        latex: "x^2 + y^2 + z^2",
                    },
                    right: ::evi_core::__private::Formula {
                        unicode: "l²",
                        latex: "l^2",
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
                        additions: 3usize,
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
                        additions: 3usize,
                        multiplications: 3usize,
                        divisions: 0usize,
                        functions: 0usize,
                    },
                    temporaries: 0usize,
                    statements: 1usize,
                },
                ::evi_core::__private::KernelReport {
                    name: "constraint_slopes",
                    operations: ::evi_core::__private::Operations {
                        additions: 3usize,
                        multiplications: 3usize,
                        divisions: 0usize,
                        functions: 0usize,
                    },
                    temporaries: 0usize,
                    statements: 1usize,
                },
                ::evi_core::__private::KernelReport {
                    name: "constraint_curvature",
                    operations: ::evi_core::__private::Operations {
                        additions: 2usize,
                        multiplications: 6usize,
                        divisions: 0usize,
                        functions: 0usize,
                    },
                    temporaries: 0usize,
                    statements: 1usize,
                },
            ],
        };
        type PerCoordinate<X: ::core::clone::Clone> = [X; 3usize];
        type PerConstraint<X: ::core::clone::Clone> = [X; 1usize];
        type PerUnknown<X: ::core::clone::Clone> = [X; 4usize];
        type PerParameter<X: ::core::clone::Clone> = [X; 3usize];
        type PerConstant<X: ::core::clone::Clone> = [X; 5usize];
        type PerHessianEntry<X: ::core::clone::Clone> = [X; 0usize];
        type PerJacobianEntry<X: ::core::clone::Clone> = [X; 3usize];
        type PerInput<X: ::core::clone::Clone> = [X; 0usize];
        type PerObservable<X: ::core::clone::Clone> = [X; 0usize];
        type PerForceEntry<X: ::core::clone::Clone> = [X; 0usize];
        type DenseKktFactors = ::evi_core::__private::DenseLu<4usize>;
        type KktFactors = ::evi_core::__private::Guarded<KktElimination, 4usize>;
        type MassFactors = ::evi_core::__private::Guarded<MassElimination, 3usize>;
        type GramFactors = ::evi_core::__private::Inverse1;
        #[inline]
        fn parameters(&self) -> Self::PerParameter<f64> {
            [self.m, self.l, self.g]
        }
        #[inline]
        fn constants<T: ::evi_core::__private::Scalar>(
            p: &Self::PerParameter<T>,
        ) -> Self::PerConstant<T> {
            let x0 = T::from_f64(0.5) * p[0usize];
            let x1 = p[0usize] * p[2usize];
            let x2 = -x1;
            let x3 = p[1usize] * p[1usize];
            [p[0usize], x0, x1, x2, x3]
        }
        #[inline]
        fn lagrangian<T: ::evi_core::__private::Scalar>(
            c: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
            v: &Self::PerCoordinate<T>,
        ) -> T {
            let x0 = (c[1usize]
                * (((v[0usize] * v[0usize]) + (v[1usize] * v[1usize]))
                    + (v[2usize] * v[2usize]))) - (c[2usize] * q[2usize]);
            x0
        }
        #[inline(always)]
        fn lagrangian_gradient<T: ::evi_core::__private::Scalar>(
            c: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
            v: &Self::PerCoordinate<T>,
        ) -> ::evi_core::__private::LagrangianGradient<Self, T> {
            let x0 = c[0usize] * v[0usize];
            let x1 = c[0usize] * v[1usize];
            let x2 = c[0usize] * v[2usize];
            ::evi_core::__private::LagrangianGradient {
                force: [T::from_f64(0.0), T::from_f64(0.0), c[3usize]],
                momentum: [x0, x1, x2],
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
            let x0 = c[0usize] * v[0usize];
            let x1 = c[0usize] * v[1usize];
            let x2 = c[0usize] * v[2usize];
            (
                ::evi_core::__private::LagrangianGradient {
                    force: [T::from_f64(0.0), T::from_f64(0.0), c[3usize]],
                    momentum: [x0, x1, x2],
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
            let x0 = (((q[0usize] * q[0usize]) + (q[1usize] * q[1usize]))
                + (q[2usize] * q[2usize])) - c[4usize];
            [x0]
        }
        #[inline(always)]
        fn constraint_slopes<T: ::evi_core::__private::Scalar>(
            c: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
        ) -> (Self::PerConstraint<T>, Self::PerJacobianEntry<T>) {
            let x0 = (((q[0usize] * q[0usize]) + (q[1usize] * q[1usize]))
                + (q[2usize] * q[2usize])) - c[4usize];
            ([x0], [q[0usize], q[1usize], q[2usize]])
        }
        #[inline]
        fn constraint_curvature<T: ::evi_core::__private::Scalar>(
            c: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
            v: &Self::PerCoordinate<T>,
        ) -> Self::PerConstraint<T> {
            let x0 = ((v[2usize] * v[2usize]) * T::from_f64(2.0))
                + (((v[0usize] * v[0usize]) * T::from_f64(2.0))
                    + ((v[1usize] * v[1usize]) * T::from_f64(2.0)));
            [x0]
        }
        #[inline(always)]
        fn for_each_slope<T: ::core::marker::Copy>(
            c: &Self::PerConstant<T>,
            g: &Self::PerJacobianEntry<T>,
            mut visit: impl ::core::ops::FnMut(usize, usize, T),
        ) {
            visit(0usize, 0usize, g[0usize]);
            visit(0usize, 1usize, g[1usize]);
            visit(0usize, 2usize, g[2usize]);
        }
        #[inline(always)]
        fn for_each_slope_pair<T: ::core::marker::Copy>(
            c: &Self::PerConstant<T>,
            g: &Self::PerJacobianEntry<T>,
            mut visit: impl ::core::ops::FnMut(usize, usize, usize, T),
        ) {
            visit(0usize, 0usize, 0usize, g[0usize]);
            visit(0usize, 0usize, 1usize, g[1usize]);
            visit(0usize, 0usize, 2usize, g[2usize]);
        }
        #[inline(always)]
        fn for_each_gram_product<T: ::core::marker::Copy>(
            c: &Self::PerConstant<T>,
            g: &Self::PerJacobianEntry<T>,
            mut visit: impl ::core::ops::FnMut(usize, usize, usize, T, T),
        ) {
            visit(0usize, 0usize, 0usize, g[0usize], g[0usize]);
            visit(0usize, 0usize, 1usize, g[1usize], g[1usize]);
            visit(0usize, 0usize, 2usize, g[2usize], g[2usize]);
        }
        #[inline(always)]
        fn for_each_vv<T: ::core::marker::Copy>(
            c: &Self::PerConstant<T>,
            h: &Self::PerHessianEntry<T>,
            mut visit: impl ::core::ops::FnMut(usize, usize, T),
        ) {
            visit(0usize, 0usize, c[0usize]);
            visit(1usize, 1usize, c[0usize]);
            visit(2usize, 2usize, c[0usize]);
        }
    }
    #[automatically_derived]
    #[allow(unused, non_snake_case, trivial_numeric_casts, clippy::all)]
    impl ::evi_core::__private::GenericSystem for SphericalPendulum {
        fn n_coordinates(&self) -> usize {
            3usize
        }
        fn n_constraints(&self) -> usize {
            1usize
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
            let __name_x = __q[0usize];
            let __name_y = __q[1usize];
            let __name_z = __q[2usize];
            let __der_x = __v[0usize];
            let __der_y = __v[1usize];
            let __der_z = __v[2usize];
            (T::from_f64(0.5f64) * __name_m
                * (__der_x.powi(2) + __der_y.powi(2) + __der_z.powi(2)))
                - (__name_m * __name_g * __name_z)
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
            let __name_x = __q[0usize];
            let __name_y = __q[1usize];
            let __name_z = __q[2usize];
            __residuals[0usize] = (__name_x.powi(2) + __name_y.powi(2)
                + __name_z.powi(2)) - (__name_l.powi(2));
        }
    }
};
