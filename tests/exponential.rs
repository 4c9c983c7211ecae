//! What the exponential part of the integrators gains, and where its limits are: matrix frequencies, the multiplier shift, fitted
//! weights, references.

mod exponential {
    mod exact;
    mod fixtures;
    mod gain;
    mod geometry;
    mod limits;
    mod linearisation;
    mod refusals;
    mod units;
}
