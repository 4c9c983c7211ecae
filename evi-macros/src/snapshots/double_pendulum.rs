// operations               + -   *   / f()
// constants                  0   6   0   0
// lagrangian                 5   9   0   0
// lagrangian_gradient        0   4   0   0
// lagrangian_derivatives     0   4   0   0
// constraints                6   4   0   0
// constraint_slopes          6   4   0   0
// constraint_curvature       4   8   0   0

const _: () = {
    #[doc(hidden)]
    pub struct KktElimination {
        e: [f64; 20usize],
    }
    #[automatically_derived]
    #[allow(clippy::all)]
    impl ::evi_core::__private::Elimination<6usize> for KktElimination {
        #[inline]
        fn factor(m: &[[f64; 6usize]; 6usize]) -> ::core::option::Option<Self> {
            let mut e = [0.0_f64; 20usize];
            let mut s = [0.0_f64; 6usize];
            e[6usize] = m[0usize][0usize];
            e[8usize] = m[0usize][4usize];
            e[10usize] = m[0usize][5usize];
            e[11usize] = m[1usize][1usize];
            e[13usize] = m[1usize][4usize];
            e[15usize] = m[1usize][5usize];
            e[0usize] = m[2usize][2usize];
            e[2usize] = m[2usize][5usize];
            e[3usize] = m[3usize][3usize];
            e[5usize] = m[3usize][5usize];
            e[7usize] = m[4usize][0usize];
            e[12usize] = m[4usize][1usize];
            e[9usize] = m[5usize][0usize];
            e[14usize] = m[5usize][1usize];
            e[1usize] = m[5usize][2usize];
            e[4usize] = m[5usize][3usize];
            s[0usize] = e[6usize].abs();
            s[1usize] = e[11usize].abs();
            s[2usize] = e[0usize].abs();
            s[3usize] = e[3usize].abs();
            e[0usize] = ::evi_core::__private::reciprocal_pivot(e[0usize], s[2usize])?;
            e[1usize] *= e[0usize];
            {
                let update = e[1usize] * e[2usize];
                e[19usize] -= update;
                s[5usize] += update.abs();
            }
            e[3usize] = ::evi_core::__private::reciprocal_pivot(e[3usize], s[3usize])?;
            e[4usize] *= e[3usize];
            {
                let update = e[4usize] * e[5usize];
                e[19usize] -= update;
                s[5usize] += update.abs();
            }
            e[6usize] = ::evi_core::__private::reciprocal_pivot(e[6usize], s[0usize])?;
            e[7usize] *= e[6usize];
            e[9usize] *= e[6usize];
            {
                let update = e[7usize] * e[8usize];
                e[16usize] -= update;
                s[4usize] += update.abs();
            }
            e[18usize] -= e[7usize] * e[10usize];
            e[17usize] -= e[9usize] * e[8usize];
            {
                let update = e[9usize] * e[10usize];
                e[19usize] -= update;
                s[5usize] += update.abs();
            }
            e[11usize] = ::evi_core::__private::reciprocal_pivot(e[11usize], s[1usize])?;
            e[12usize] *= e[11usize];
            e[14usize] *= e[11usize];
            {
                let update = e[12usize] * e[13usize];
                e[16usize] -= update;
                s[4usize] += update.abs();
            }
            e[18usize] -= e[12usize] * e[15usize];
            e[17usize] -= e[14usize] * e[13usize];
            {
                let update = e[14usize] * e[15usize];
                e[19usize] -= update;
                s[5usize] += update.abs();
            }
            e[16usize] = ::evi_core::__private::reciprocal_pivot(e[16usize], s[4usize])?;
            e[17usize] *= e[16usize];
            {
                let update = e[17usize] * e[18usize];
                e[19usize] -= update;
                s[5usize] += update.abs();
            }
            e[19usize] = ::evi_core::__private::reciprocal_pivot(e[19usize], s[5usize])?;
            ::core::option::Option::Some(Self { e })
        }
        #[inline]
        fn solve(&self, b: &mut [f64; 6usize]) {
            let e = &self.e;
            b[5usize] -= e[1usize] * b[2usize];
            b[5usize] -= e[4usize] * b[3usize];
            b[4usize] -= e[7usize] * b[0usize];
            b[5usize] -= e[9usize] * b[0usize];
            b[4usize] -= e[12usize] * b[1usize];
            b[5usize] -= e[14usize] * b[1usize];
            b[5usize] -= e[17usize] * b[4usize];
            b[5usize] = (b[5usize]) * e[19usize];
            b[4usize] = (b[4usize] - e[18usize] * b[5usize]) * e[16usize];
            b[1usize] = (b[1usize] - e[13usize] * b[4usize] - e[15usize] * b[5usize])
                * e[11usize];
            b[0usize] = (b[0usize] - e[8usize] * b[4usize] - e[10usize] * b[5usize])
                * e[6usize];
            b[3usize] = (b[3usize] - e[5usize] * b[5usize]) * e[3usize];
            b[2usize] = (b[2usize] - e[2usize] * b[5usize]) * e[0usize];
        }
    }
    #[doc(hidden)]
    pub struct MassElimination {
        e: [f64; 4usize],
    }
    #[automatically_derived]
    #[allow(clippy::all)]
    impl ::evi_core::__private::Elimination<4usize> for MassElimination {
        #[inline]
        fn factor(m: &[[f64; 4usize]; 4usize]) -> ::core::option::Option<Self> {
            let mut e = [0.0_f64; 4usize];
            let mut s = [0.0_f64; 4usize];
            e[0usize] = m[0usize][0usize];
            e[1usize] = m[1usize][1usize];
            e[2usize] = m[2usize][2usize];
            e[3usize] = m[3usize][3usize];
            s[0usize] = e[0usize].abs();
            s[1usize] = e[1usize].abs();
            s[2usize] = e[2usize].abs();
            s[3usize] = e[3usize].abs();
            e[0usize] = ::evi_core::__private::reciprocal_pivot(e[0usize], s[0usize])?;
            e[1usize] = ::evi_core::__private::reciprocal_pivot(e[1usize], s[1usize])?;
            e[2usize] = ::evi_core::__private::reciprocal_pivot(e[2usize], s[2usize])?;
            e[3usize] = ::evi_core::__private::reciprocal_pivot(e[3usize], s[3usize])?;
            ::core::option::Option::Some(Self { e })
        }
        #[inline]
        fn solve(&self, b: &mut [f64; 4usize]) {
            let e = &self.e;
            b[3usize] = (b[3usize]) * e[3usize];
            b[2usize] = (b[2usize]) * e[2usize];
            b[1usize] = (b[1usize]) * e[1usize];
            b[0usize] = (b[0usize]) * e[0usize];
        }
    }
    #[automatically_derived]
    #[allow(unused_variables, unused_parens, trivial_numeric_casts, clippy::all)]
    impl ::evi_core::__private::MechanicalSystem for DoublePendulum {
        const COORDINATES: &'static [&'static str] = &["x1", "y1", "x2", "y2"];
        const CONSTRAINTS: &'static [&'static str] = &["rod1", "rod2"];
        const PARAMETERS: &'static [&'static str] = &["m1", "m2", "l1", "l2", "g"];
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
                        value: ::evi_core::__private::EntryValue::Constant(1usize),
                    },
                    ::evi_core::__private::Entry {
                        row: 3usize,
                        col: 3usize,
                        value: ::evi_core::__private::EntryValue::Constant(1usize),
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
                        row: 1usize,
                        col: 0usize,
                        value: ::evi_core::__private::EntryValue::Varying(2usize),
                    },
                    ::evi_core::__private::Entry {
                        row: 1usize,
                        col: 1usize,
                        value: ::evi_core::__private::EntryValue::Varying(3usize),
                    },
                    ::evi_core::__private::Entry {
                        row: 1usize,
                        col: 2usize,
                        value: ::evi_core::__private::EntryValue::Varying(4usize),
                    },
                    ::evi_core::__private::Entry {
                        row: 1usize,
                        col: 3usize,
                        value: ::evi_core::__private::EntryValue::Varying(5usize),
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
                ::evi_core::__private::ConstraintStructure {
                    gradient: ::evi_core::__private::Block::Varying(::evi_core::__private::Dependence {
                        on_q: true,
                        on_v: false,
                        on_t: false,
                    }),
                    on_t: false,
                    is_quadratic: true,
                    is_sphere: false,
                    repeats: ::core::option::Option::None,
                },
            ],
            constraint_graph: &[(0usize, 1usize)],
            forces: ::evi_core::__private::ForceStructure::NONE,
            central_force: ::core::option::Option::None,
            operations: ::evi_core::__private::KernelOperations {
                constants: ::evi_core::__private::Operations {
                    additions: 0usize,
                    multiplications: 6usize,
                    divisions: 0usize,
                    functions: 0usize,
                },
                lagrangian: ::evi_core::__private::Operations {
                    additions: 5usize,
                    multiplications: 9usize,
                    divisions: 0usize,
                    functions: 0usize,
                },
                lagrangian_gradient: ::evi_core::__private::Operations {
                    additions: 0usize,
                    multiplications: 4usize,
                    divisions: 0usize,
                    functions: 0usize,
                },
                lagrangian_derivatives: ::evi_core::__private::Operations {
                    additions: 0usize,
                    multiplications: 4usize,
                    divisions: 0usize,
                    functions: 0usize,
                },
                constraints: ::evi_core::__private::Operations {
                    additions: 6usize,
                    multiplications: 4usize,
                    divisions: 0usize,
                    functions: 0usize,
                },
                constraint_slopes: ::evi_core::__private::Operations {
                    additions: 6usize,
                    multiplications: 4usize,
                    divisions: 0usize,
                    functions: 0usize,
                },
                constraint_curvature: ::evi_core::__private::Operations {
                    additions: 4usize,
                    multiplications: 8usize,
                    divisions: 0usize,
                    functions: 0usize,
                },
            },
        };
        const REPORT: ::evi_core::__private::SystemReport = ::evi_core::__private::SystemReport {
            name: "DoublePendulum",
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
                        unicode: "½ m₁ (ẋ₁² + ẏ₁²) + ½ m₂ (ẋ₂² + ẏ₂²)",
                        latex: "\\frac{1}{2} m_1 (\\dot{x}_1^2 + \\dot{y}_1^2) + \\frac{1}{2} m_2 (\\dot{x}_2^2 + \\dot{y}_2^2)",
                    },
                },
                ::evi_core::__private::Equation {
                    name: "",
                    left: ::evi_core::__private::Formula {
                        unicode: "V",
                        latex: "V",
                    },
                    right: ::evi_core::__private::Formula {
                        unicode: "g (m₁ y₁ + m₂ y₂)",
                        latex: "g (m_1 y_1 + m_2 y_2)",
                    },
                },
                ::evi_core::__private::Equation {
                    name: "rod1",
                    left: ::evi_core::__private::Formula {
                        unicode: "x₁² + y₁²",
                        latex: "x_1^2 + y_1^2",
                    },
                    right: ::evi_core::__private::Formula {
                        unicode: "l₁²",
                        latex: "l_1^2",
                    },
                },
                ::evi_core::__private::Equation {
                    name: "rod2",
                    left: ::evi_core::__private::Formula {
                        unicode: "(x₂ − x₁)² + (y₂ − y₁)²",
                        latex: "(x_2 - x_1)^2 + (y_2 - y_1)^2",
                    },
                    right: ::evi_core::__private::Formula {
                        unicode: "l₂²",
                        latex: "l_2^2",
                    },
                },
            ],
            structure: Self::STRUCTURE,
            kernels: &[
                ::evi_core::__private::KernelReport {
                    name: "constants",
                    operations: ::evi_core::__private::Operations {
                        additions: 0usize,
                        multiplications: 6usize,
                        divisions: 0usize,
                        functions: 0usize,
                    },
                    temporaries: 0usize,
                    statements: 6usize,
                },
                ::evi_core::__private::KernelReport {
                    name: "lagrangian",
                    operations: ::evi_core::__private::Operations {
                        additions: 5usize,
                        multiplications: 9usize,
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
                        multiplications: 4usize,
                        divisions: 0usize,
                        functions: 0usize,
                    },
                    temporaries: 0usize,
                    statements: 4usize,
                },
                ::evi_core::__private::KernelReport {
                    name: "lagrangian_derivatives",
                    operations: ::evi_core::__private::Operations {
                        additions: 0usize,
                        multiplications: 4usize,
                        divisions: 0usize,
                        functions: 0usize,
                    },
                    temporaries: 0usize,
                    statements: 4usize,
                },
                ::evi_core::__private::KernelReport {
                    name: "constraints",
                    operations: ::evi_core::__private::Operations {
                        additions: 6usize,
                        multiplications: 4usize,
                        divisions: 0usize,
                        functions: 0usize,
                    },
                    temporaries: 2usize,
                    statements: 4usize,
                },
                ::evi_core::__private::KernelReport {
                    name: "constraint_slopes",
                    operations: ::evi_core::__private::Operations {
                        additions: 6usize,
                        multiplications: 4usize,
                        divisions: 0usize,
                        functions: 0usize,
                    },
                    temporaries: 0usize,
                    statements: 6usize,
                },
                ::evi_core::__private::KernelReport {
                    name: "constraint_curvature",
                    operations: ::evi_core::__private::Operations {
                        additions: 4usize,
                        multiplications: 8usize,
                        divisions: 0usize,
                        functions: 0usize,
                    },
                    temporaries: 2usize,
                    statements: 4usize,
                },
            ],
        };
        type PerCoordinate<X: ::core::clone::Clone> = [X; 4usize];
        type PerConstraint<X: ::core::clone::Clone> = [X; 2usize];
        type PerUnknown<X: ::core::clone::Clone> = [X; 6usize];
        type PerParameter<X: ::core::clone::Clone> = [X; 5usize];
        type PerConstant<X: ::core::clone::Clone> = [X; 9usize];
        type PerHessianEntry<X: ::core::clone::Clone> = [X; 0usize];
        type PerJacobianEntry<X: ::core::clone::Clone> = [X; 6usize];
        type PerInput<X: ::core::clone::Clone> = [X; 0usize];
        type PerObservable<X: ::core::clone::Clone> = [X; 0usize];
        type PerForceEntry<X: ::core::clone::Clone> = [X; 0usize];
        type DenseKktFactors = ::evi_core::__private::DenseLu<6usize>;
        type KktFactors = ::evi_core::__private::Guarded<KktElimination, 6usize>;
        type MassFactors = ::evi_core::__private::Guarded<MassElimination, 4usize>;
        type GramFactors = ::evi_core::__private::Inverse2;
        #[inline]
        fn parameters(&self) -> Self::PerParameter<f64> {
            [self.m1, self.m2, self.l1, self.l2, self.g]
        }
        #[inline]
        fn constants<T: ::evi_core::__private::Scalar>(
            p: &Self::PerParameter<T>,
        ) -> Self::PerConstant<T> {
            let x0 = T::from_f64(0.5) * p[0usize];
            let x1 = T::from_f64(0.5) * p[1usize];
            let x2 = -(p[0usize] * p[4usize]);
            let x3 = -(p[1usize] * p[4usize]);
            let x4 = p[2usize] * p[2usize];
            let x5 = p[3usize] * p[3usize];
            [p[0usize], p[1usize], x0, x1, p[4usize], x2, x3, x4, x5]
        }
        #[inline]
        fn lagrangian<T: ::evi_core::__private::Scalar>(
            c: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
            v: &Self::PerCoordinate<T>,
        ) -> T {
            let x0 = ((c[2usize] * ((v[0usize] * v[0usize]) + (v[1usize] * v[1usize])))
                + (c[3usize] * ((v[2usize] * v[2usize]) + (v[3usize] * v[3usize]))))
                - (c[4usize] * ((c[0usize] * q[1usize]) + (c[1usize] * q[3usize])));
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
            let x2 = c[1usize] * v[2usize];
            let x3 = c[1usize] * v[3usize];
            ::evi_core::__private::LagrangianGradient {
                force: [T::from_f64(0.0), c[5usize], T::from_f64(0.0), c[6usize]],
                momentum: [x0, x1, x2, x3],
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
            let x2 = c[1usize] * v[2usize];
            let x3 = c[1usize] * v[3usize];
            (
                ::evi_core::__private::LagrangianGradient {
                    force: [T::from_f64(0.0), c[5usize], T::from_f64(0.0), c[6usize]],
                    momentum: [x0, x1, x2, x3],
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
            let x0 = q[2usize] - q[0usize];
            let x1 = q[3usize] - q[1usize];
            let x2 = ((q[0usize] * q[0usize]) + (q[1usize] * q[1usize])) - c[7usize];
            let x3 = ((x0 * x0) + (x1 * x1)) - c[8usize];
            [x2, x3]
        }
        #[inline(always)]
        fn constraint_slopes<T: ::evi_core::__private::Scalar>(
            c: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
        ) -> (Self::PerConstraint<T>, Self::PerJacobianEntry<T>) {
            let x0 = q[2usize] - q[0usize];
            let x1 = q[3usize] - q[1usize];
            let x2 = ((q[0usize] * q[0usize]) + (q[1usize] * q[1usize])) - c[7usize];
            let x3 = ((x0 * x0) + (x1 * x1)) - c[8usize];
            let x4 = -x0;
            let x5 = -x1;
            ([x2, x3], [q[0usize], q[1usize], x4, x5, x0, x1])
        }
        #[inline]
        fn constraint_curvature<T: ::evi_core::__private::Scalar>(
            c: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
            v: &Self::PerCoordinate<T>,
        ) -> Self::PerConstraint<T> {
            let x0 = ((v[0usize] * v[0usize]) * T::from_f64(2.0))
                + ((v[1usize] * v[1usize]) * T::from_f64(2.0));
            let x1 = v[2usize] - v[0usize];
            let x2 = v[3usize] - v[1usize];
            let x3 = (T::from_f64(2.0) * (x1 * x1)) + (T::from_f64(2.0) * (x2 * x2));
            [x0, x3]
        }
        #[inline(always)]
        fn for_each_slope<T: ::core::marker::Copy>(
            c: &Self::PerConstant<T>,
            g: &Self::PerJacobianEntry<T>,
            mut visit: impl ::core::ops::FnMut(usize, usize, T),
        ) {
            visit(0usize, 0usize, g[0usize]);
            visit(0usize, 1usize, g[1usize]);
            visit(1usize, 0usize, g[2usize]);
            visit(1usize, 1usize, g[3usize]);
            visit(1usize, 2usize, g[4usize]);
            visit(1usize, 3usize, g[5usize]);
        }
        #[inline(always)]
        fn for_each_slope_pair<T: ::core::marker::Copy>(
            c: &Self::PerConstant<T>,
            g: &Self::PerJacobianEntry<T>,
            mut visit: impl ::core::ops::FnMut(usize, usize, usize, T),
        ) {
            visit(0usize, 0usize, 0usize, g[0usize]);
            visit(0usize, 1usize, 0usize, g[0usize]);
            visit(0usize, 0usize, 1usize, g[1usize]);
            visit(0usize, 1usize, 1usize, g[1usize]);
            visit(1usize, 0usize, 0usize, g[2usize]);
            visit(1usize, 1usize, 0usize, g[2usize]);
            visit(1usize, 0usize, 1usize, g[3usize]);
            visit(1usize, 1usize, 1usize, g[3usize]);
            visit(1usize, 1usize, 2usize, g[4usize]);
            visit(1usize, 1usize, 3usize, g[5usize]);
        }
        #[inline(always)]
        fn for_each_gram_product<T: ::core::marker::Copy>(
            c: &Self::PerConstant<T>,
            g: &Self::PerJacobianEntry<T>,
            mut visit: impl ::core::ops::FnMut(usize, usize, usize, T, T),
        ) {
            visit(0usize, 0usize, 0usize, g[0usize], g[0usize]);
            visit(0usize, 0usize, 1usize, g[1usize], g[1usize]);
            visit(1usize, 0usize, 0usize, g[2usize], g[0usize]);
            visit(1usize, 1usize, 0usize, g[2usize], g[2usize]);
            visit(1usize, 0usize, 1usize, g[3usize], g[1usize]);
            visit(1usize, 1usize, 1usize, g[3usize], g[3usize]);
            visit(1usize, 1usize, 2usize, g[4usize], g[4usize]);
            visit(1usize, 1usize, 3usize, g[5usize], g[5usize]);
        }
        #[inline(always)]
        fn for_each_vv<T: ::core::marker::Copy>(
            c: &Self::PerConstant<T>,
            h: &Self::PerHessianEntry<T>,
            mut visit: impl ::core::ops::FnMut(usize, usize, T),
        ) {
            visit(0usize, 0usize, c[0usize]);
            visit(1usize, 1usize, c[0usize]);
            visit(2usize, 2usize, c[1usize]);
            visit(3usize, 3usize, c[1usize]);
        }
    }
    #[automatically_derived]
    #[allow(unused, non_snake_case, trivial_numeric_casts, clippy::all)]
    impl ::evi_core::__private::GenericSystem for DoublePendulum {
        fn n_coordinates(&self) -> usize {
            4usize
        }
        fn n_constraints(&self) -> usize {
            2usize
        }
        fn lagrangian<T: ::evi_core::__private::Scalar>(
            &self,
            t: T,
            __q: &[T],
            __v: &[T],
        ) -> T {
            let __name_m1 = T::from_f64(self.m1);
            let __name_m2 = T::from_f64(self.m2);
            let __name_l1 = T::from_f64(self.l1);
            let __name_l2 = T::from_f64(self.l2);
            let __name_g = T::from_f64(self.g);
            let __name_x1 = __q[0usize];
            let __name_y1 = __q[1usize];
            let __name_x2 = __q[2usize];
            let __name_y2 = __q[3usize];
            let __der_x1 = __v[0usize];
            let __der_y1 = __v[1usize];
            let __der_x2 = __v[2usize];
            let __der_y2 = __v[3usize];
            (T::from_f64(0.5f64) * __name_m1 * (__der_x1.powi(2) + __der_y1.powi(2))
                + T::from_f64(0.5f64) * __name_m2
                    * (__der_x2.powi(2) + __der_y2.powi(2)))
                - (__name_g * (__name_m1 * __name_y1 + __name_m2 * __name_y2))
        }
        fn constraints<T: ::evi_core::__private::Scalar>(
            &self,
            t: T,
            __q: &[T],
            __residuals: &mut [T],
        ) {
            let __name_m1 = T::from_f64(self.m1);
            let __name_m2 = T::from_f64(self.m2);
            let __name_l1 = T::from_f64(self.l1);
            let __name_l2 = T::from_f64(self.l2);
            let __name_g = T::from_f64(self.g);
            let __name_x1 = __q[0usize];
            let __name_y1 = __q[1usize];
            let __name_x2 = __q[2usize];
            let __name_y2 = __q[3usize];
            __residuals[0usize] = (__name_x1.powi(2) + __name_y1.powi(2))
                - (__name_l1.powi(2));
            __residuals[1usize] = ((__name_x2 - __name_x1).powi(2)
                + (__name_y2 - __name_y1).powi(2)) - (__name_l2.powi(2));
        }
    }
};
