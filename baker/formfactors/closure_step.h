/// One step of closure (closure.h): from the row sums at mu to the next mu. Knows nothing of pairs, only one number
/// each per patch, so that a step costs no read.
///
/// Own root. Near mu_i the pairs' sum of a row is replaced by alpha / (x + beta) with the same value and `damping`
/// times the same slope; alpha / (x + beta) + fixed_i / x = A_i is a quadratic with one root in x >= 0. With one partner
/// and damping 1 the replacement is exact. All rows move at once, so a row and its partners all answer the same error;
/// a slope taken too steep keeps that from overshooting (the derivative of the rows, scaled by its diagonal, has its
/// eigenvalues in [0, 2], so any damping above 1 converges near the solution).
///
/// Mixing. Anderson acceleration (Walker and Ni, SIAM J. Numer. Anal. 49, 2011): with f(x) = root(x) - x, the last
/// `depth` differences of x and f are combined so that f would vanish in the least squares sense, weighted by the
/// slopes; a linear problem would be solved as by GMRES, at one pass per step. Where f grew, the memory is dropped.
///
/// Memory: 2 * depth + 2 doubles per patch. Threads: none; sums run in patch order, so results are the same everywhere.
#pragma once
#include <deque>
#include <span>
#include <vector>

namespace luxel {

/// What one pass over the counts found, per patch.
struct RowState {
    std::vector<double> pairs_m2;  ///< sum over j != i of G_ij
    std::vector<double> slope;     ///< sum over j != i of G_ij / (mu_i + mu_j): minus the derivative by mu_i
};

/// The root in x >= lowest of alpha / (x + beta) + fixed / x = area. mu >= 0, pairs_m2 >= 0, fixed >= 0 in rays;
/// a row with neither pairs nor fixed stays where it is.
double own_root(double mu, double pairs_m2, double slope, double fixed, double area_m2, double lowest);

class ClosureSteps {
  public:
    /// All spans per patch; they must outlive this. `fixed`: rays that ended on the patch itself or in the open.
    /// `lowest`: mu is never taken below.
    ClosureSteps(std::span<const double> area_m2, std::span<const double> fixed, std::span<const double> lowest)
        : area_m2_(area_m2), fixed_(fixed), lowest_(lowest) {}
    void advance(const RowState& rows, std::vector<double>& mu);

  private:
    /// Weights of the remembered differences; empty when there are none that can be told apart.
    [[nodiscard]] std::vector<double> mixing_weights(std::span<const double> roots, std::span<const double> f,
                                                     std::span<const double> metric) const;

    std::span<const double> area_m2_, fixed_, lowest_;
    std::vector<double> last_mu_, last_f_;
    std::deque<std::vector<double>> mu_changes_, f_changes_;
    double least_residual_ = 0;
    bool begun_ = false;
};

}  // namespace luxel
