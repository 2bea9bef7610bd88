/// Powers with a fifth in their exponent, as transfer curves have them: 2.4 of sRGB, 2.2 of RGBM.
///
/// Threads  pure, also while compiling. Only + - * /: the same bits on every machine, unlike a mathematical library's pow.
/// Source   Newton's method for y^5 = x.
#pragma once

namespace luxel {

/// y with y^5 = x for x in [0, 1.1], to the last bit or two. From above the method is monotone, so it stops by itself.
constexpr double fifth_root(double x) {
    if (!(x > 0)) return 0;
    double y = 1.1;
    for (;;) {
        const double square = y * y;
        const double next = (4.0 * y + x / (square * square)) / 5.0;
        if (!(next < y)) return y;
        y = next;
    }
}

}  // namespace luxel
