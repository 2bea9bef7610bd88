/// The few special functions that the self-check's tests need. Pure; relative error below 1e-8 where a probability is
/// above 1e-280.
#pragma once

namespace luxel {

/// Probability that a Student variable with `freedom` > 0 degrees of freedom is farther from 0 than t >= 0, either side.
double student_tail(double t, double freedom);

/// Derivative of ln Gamma, and its derivative; x > 0.
double digamma(double x);
double trigamma(double x);
/// x > 0 with trigamma(x) = y; y > 0.
double inverse_trigamma(double y);

}  // namespace luxel
