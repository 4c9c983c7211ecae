//! A function that can panic: must not link. It shows that those of the other program could fail to.

use std::hint::black_box;

use no_panic::no_panic;

#[no_panic]
#[inline(never)]
fn can_panic(numbers: &[f64], index: usize) -> f64 {
    numbers[index]
}

fn main() {
    println!("{}", can_panic(black_box(&[1.0]), black_box(0)));
}
