//! The report as it is printed.

use super::*;

#[track_caller]
fn check_report<S: MechanicalSystem>(expected: Expect) {
    expected.assert_eq(&S::REPORT.to_string());
}

#[test]
fn report_of_the_double_pendulum() {
    check_report::<DoublePendulum>(expect![[r#"
        DoublePendulum
          coordinates  x1, y1, x2, y2
          parameters   m1, m2, l1, l2, g

        Equations
                L = T − V
                T = ½ m₁ (ẋ₁² + ẏ₁²) + ½ m₂ (ẋ₂² + ẏ₂²)
                V = g (m₁ y₁ + m₂ y₂)
          rod1: x₁² + y₁² = l₁²
          rod2: (x₂ − x₁)² + (y₂ − y₁)² = l₂²

        Structure
          mass matrix  constant, diagonal
          potential    affine in q
          Hessian of L qq zero, vq zero, vv constant, vt zero
          momentum     zero at rest
          time         appears nowhere
          constraints  nonlinear in q: rod1, rod2
                       share a coordinate: rod1–rod2

        Matrix of a step   · zero, c constant, x varying
                x1 y1 x2 y2 │ rod1 rod2
            x1  c  ·  ·  ·  │  x    x
            y1  ·  c  ·  ·  │  x    x
            x2  ·  ·  c  ·  │  ·    x
            y2  ·  ·  ·  c  │  ·    x
          rod1  x  x  ·  ·  │  ·    ·
          rod2  x  x  x  x  │  ·    ·
          unknowns: 6; 2 once the positions are eliminated, for L is quadratic

        Operations per call      + −     ×     ÷  f(x)   temporaries  statements
          constants                  ·     6     ·     ·             ·           6
          lagrangian                 5     9     ·     ·             ·           1
          lagrangian_gradient        ·     4     ·     ·             ·           4
          lagrangian_derivatives     ·     4     ·     ·             ·           4
          constraints                6     4     ·     ·             2           4
          constraint_slopes          6     4     ·     ·             ·           6
          constraint_curvature       4     8     ·     ·             2           4

        Left out
          mass matrix: constant, folded once per run
          iteration for the velocity: it is linear in the momentum
          potential Hessian: zero, the force is uniform
          coupling of positions and velocities: zero
          time derivatives: time appears nowhere
    "#]]);
}

#[test]
fn report_of_the_pendulum_in_an_angle() {
    check_report::<Pendulum>(expect![[r#"
        Pendulum
          coordinates  theta
          parameters   m, l, g

        Equations
          L = T − V
          T = ½ m l² θ̇²
          V = −m g l cos θ

        Structure
          mass matrix  constant, diagonal
          potential    general in q
          Hessian of L qq varies with q, vq zero, vv constant, vt zero
          momentum     zero at rest
          time         appears nowhere
          constraints  none

        Matrix of a step   · zero, c constant, x varying
                 theta
          theta    x
          unknowns: 1

        Operations per call      + −     ×     ÷  f(x)   temporaries  statements
          constants                  ·     5     ·     ·             ·           3
          lagrangian                 1     3     ·     1             1           2
          lagrangian_gradient        ·     2     ·     1             1           3
          lagrangian_derivatives     ·     3     ·     2             2           4

        Left out
          mass matrix: constant, folded once per run
          iteration for the velocity: it is linear in the momentum
          coupling of positions and velocities: zero
          time derivatives: time appears nowhere
          multipliers: the scene has no constraints
    "#]]);
}

#[test]
fn report_of_a_scene_with_forces() {
    check_report::<DrivenPendulum>(expect![[r#"
        DrivenPendulum
          coordinates  x, y
          parameters   m, l, g, c, a, w
          observed     angle, power

        Equations
               L = T − V
               T = ½ m (ẋ² + ẏ²)
               V = m g y
               D = ½ drag
               f_x = drive
               angle = atan2(x, −y)
               power = drive ẋ − drag
               drag = c (ẋ² + ẏ²)
               drive = a cos(w t)
          rod: x² + y² = l²

        Structure
          mass matrix  constant, diagonal
          potential    affine in q
          Hessian of L qq zero, vq zero, vv constant, vt zero
          momentum     zero at rest
          time         in the forces
          forces       on x, y; vary with v and t
          constraints  nonlinear in q: rod

        Matrix of a step   · zero, c constant, x varying
               x y │ rod
            x  c · │  x
            y  · c │  x
          rod  x x │  ·
          unknowns: 3

        Operations per call      + −     ×     ÷  f(x)   temporaries  statements
          constants                  ·     3     ·     ·             ·           5
          lagrangian                 2     4     ·     ·             ·           1
          lagrangian_gradient        ·     2     ·     ·             ·           2
          lagrangian_derivatives     ·     2     ·     ·             ·           2
          constraints                2     2     ·     ·             ·           1
          constraint_slopes          2     2     ·     ·             ·           1
          constraint_curvature       1     4     ·     ·             ·           1
          forces                     1     4     ·     1             1           3
          force_derivatives          1     4     ·     1             1           3
          observables                2     6     ·     2             1           3

        Left out
          mass matrix: constant, folded once per run
          iteration for the velocity: it is linear in the momentum
          potential Hessian: zero, the force is uniform
          coupling of positions and velocities: zero
    "#]]);
}

#[test]
fn report_of_the_spherical_pendulum() {
    check_report::<SphericalPendulum>(expect![[r#"
        SphericalPendulum
          coordinates  x, y, z
          parameters   m, l, g

        Equations
               L = T − V
               T = ½ m (ẋ² + ẏ² + ż²)
               V = m g z
          rod: x² + y² + z² = l²

        Structure
          mass matrix  constant, diagonal
          potential    affine in q
          Hessian of L qq zero, vq zero, vv constant, vt zero
          momentum     zero at rest
          time         appears nowhere
          constraints  nonlinear in q: rod

        Matrix of a step   · zero, c constant, x varying
               x y z │ rod
            x  c · · │  x
            y  · c · │  x
            z  · · c │  x
          rod  x x x │  ·
          unknowns: 4; 1 once the positions are eliminated, for L is quadratic

        Operations per call      + −     ×     ÷  f(x)   temporaries  statements
          constants                  ·     3     ·     ·             ·           4
          lagrangian                 3     5     ·     ·             ·           1
          lagrangian_gradient        ·     3     ·     ·             ·           3
          lagrangian_derivatives     ·     3     ·     ·             ·           3
          constraints                3     3     ·     ·             ·           1
          constraint_slopes          3     3     ·     ·             ·           1
          constraint_curvature       2     6     ·     ·             ·           1

        Left out
          mass matrix: constant, folded once per run
          iteration for the velocity: it is linear in the momentum
          potential Hessian: zero, the force is uniform
          coupling of positions and velocities: zero
          time derivatives: time appears nowhere
    "#]]);
}

#[test]
fn report_of_the_stiff_spring_pendulum() {
    check_report::<StiffSpringPendulum>(expect![[r#"
        StiffSpringPendulum
          coordinates  x, y
          parameters   m, l, k, g

        Equations
          L = T − V
          T = ½ m (ẋ² + ẏ²)
          V = ½ k stretch² + m g y
          stretch = √(x² + y²) − l

        Structure
          mass matrix  constant, diagonal
          potential    quadratic in one distance, with terms affine in q
          Hessian of L qq varies with q, vq zero, vv constant, vt zero
          momentum     zero at rest
          time         appears nowhere
          constraints  none

        Matrix of a step   · zero, c constant, x varying
             x y
          x  x x
          y  x x
          unknowns: 2; 1 in midpoint steps, a distance, for the force is central

        Operations per call      + −     ×     ÷  f(x)   temporaries  statements
          constants                  ·     3     ·     ·             ·           4
          lagrangian                 5     8     ·     1             1           2
          lagrangian_gradient        3    10     1     1             3           7
          lagrangian_derivatives     8    25     1     1             7          14
          squared_distance           1     2     ·     ·             ·           1
          central_force              1     1     ·     ·             ·           1

        Left out
          mass matrix: constant, folded once per run
          iteration for the velocity: it is linear in the momentum
          coupling of positions and velocities: zero
          time derivatives: time appears nowhere
          multipliers: the scene has no constraints
          iteration for the distance in midpoint steps: the force is linear in it
    "#]]);
}

#[test]
fn report_of_the_oscillator() {
    check_report::<HarmonicOscillator>(expect![[r#"
        HarmonicOscillator
          coordinates  x
          parameters   m, k

        Equations
          L = T − V
          T = ½ m ẋ²
          V = ½ k x²

        Structure
          mass matrix  constant, diagonal
          potential    quadratic in q
          Hessian of L qq constant, vq zero, vv constant, vt zero
          momentum     zero at rest
          time         appears nowhere
          constraints  none

        Matrix of a step   · zero, c constant, x varying
             x
          x  c
          unknowns: 1; none once the positions are eliminated, for L is quadratic

        Operations per call      + −     ×     ÷  f(x)   temporaries  statements
          constants                  ·     2     ·     ·             ·           3
          lagrangian                 1     4     ·     ·             ·           1
          lagrangian_gradient        ·     2     ·     ·             ·           2
          lagrangian_derivatives     ·     2     ·     ·             ·           2

        Left out
          mass matrix: constant, folded once per run
          iteration for the velocity: it is linear in the momentum
          potential Hessian: constant, folded once per run
          coupling of positions and velocities: zero
          time derivatives: time appears nowhere
          multipliers: the scene has no constraints
    "#]]);
}

#[test]
fn report_of_many_kinds_of_constraints() {
    check_report::<Chain>(expect![[r#"
        Chain
          coordinates  a, b, c
          parameters   m, k, l

        Equations
                   L = T − V
                   T = ½ m (ȧ + ḃ)² + ḃ² + ċ²
                   V = ½ k (cos t + 2) (a² + b c)
          plane:   a + b = l
          turning: b cos t + c sin t = 0
          circle:  b² + c² = l²
          again:   l = a + b
          alone:   c = 3 l

        Structure
          mass matrix  constant, 2 uncoupled blocks
          potential    quadratic in q
          Hessian of L qq varies with t, vq zero, vv constant, vt zero
          momentum     zero at rest
          time         in the Lagrangian and in the constraints
          constraints  affine in q, gradient constant: plane, again, alone
                       affine in q, gradient varies with t: turning
                       nonlinear in q: circle
                       share a coordinate: plane–turning, plane–circle, plane–again, turning–circle, turning–again, turning–alone and 2 more

        Matrix of a step   · zero, c constant, x varying
                   a b c │ plane turning circle again alone
                a  x c · │   c      ·      ·      c     ·
                b  c c x │   c      x      x      c     ·
                c  · x c │   ·      x      x      ·     c
            plane  c c · │   ·      ·      ·      ·     ·
          turning  · x x │   ·      ·      ·      ·     ·
           circle  · x x │   ·      ·      ·      ·     ·
            again  c c · │   ·      ·      ·      ·     ·
            alone  · · c │   ·      ·      ·      ·     ·
          unknowns: 8

        Operations per call      + −     ×     ÷  f(x)   temporaries  statements
          constants                  1     4     ·     ·             ·           5
          lagrangian                 6     8     ·     1             2           3
          lagrangian_gradient        3     9     ·     1             2           8
          lagrangian_derivatives     3    11     ·     1             2          10
          constraints                7     4     ·     2             3           7
          constraint_slopes          8     8     ·     2             1          10
          constraint_curvature       6     8     ·     2             4           5

        Left out
          mass matrix: constant, folded once per run
          iteration for the velocity: it is linear in the momentum
          coupling of positions and velocities: zero

        Warnings
          constraint again repeats plane: their multipliers are not unique
    "#]]);
}
