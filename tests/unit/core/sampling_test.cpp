#include "baker/core/sampling.h"

#include <gtest/gtest.h>

#include <cmath>

namespace luxel {
namespace {

TEST(Sampling, CosineDirectionHasTheMomentsOfACosineLobe) {
    double mean_z = 0, mean_x = 0, mean_xx = 0;
    constexpr int n = 400;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const Vec3f d = cosine_direction((static_cast<float>(i) + 0.5f) / n, (static_cast<float>(j) + 0.5f) / n);
            ASSERT_NEAR(d.length(), 1, 1e-5);
            ASSERT_GT(d.z, 0);
            mean_z += static_cast<double>(d.z);
            mean_x += static_cast<double>(d.x);
            mean_xx += static_cast<double>(d.x) * static_cast<double>(d.x);
        }
    EXPECT_NEAR(mean_z / (n * n), 2.0 / 3.0, 1e-4);  // integral of cos^2 / pi over the hemisphere
    EXPECT_NEAR(mean_x / (n * n), 0, 1e-6);
    EXPECT_NEAR(mean_xx / (n * n), 0.25, 1e-4);
}

TEST(Sampling, TrianglePointIsUniformAndInside) {
    double sum_1 = 0, sum_2 = 0;
    constexpr int n = 200;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const Vec2f b = triangle_point((static_cast<float>(i) + 0.5f) / n, (static_cast<float>(j) + 0.5f) / n);
            ASSERT_GE(b.x, 0);
            ASSERT_GE(b.y, 0);
            ASSERT_LE(b.x + b.y, 1.000001f);
            sum_1 += static_cast<double>(b.x);
            sum_2 += static_cast<double>(b.y);
        }
    EXPECT_NEAR(sum_1 / (n * n), 1.0 / 3.0, 1e-3);
    EXPECT_NEAR(sum_2 / (n * n), 1.0 / 3.0, 1e-3);
}

TEST(Sampling, FrameIsOrthonormalForAllNormals) {
    for (int k = 0; k < 1000; ++k) {
        const float a = static_cast<float>(k) * 0.7f, z = -1 + 2 * static_cast<float>(k) / 999;
        const float r = std::sqrt(std::max(0.0f, 1 - z * z));
        const Vec3f n(r * std::cos(a), r * std::sin(a), z);
        const Frame frame(n);
        EXPECT_NEAR(frame.tangent.dot(n), 0, 1e-5);
        EXPECT_NEAR(frame.tangent.dot(frame.bitangent), 0, 1e-5);
        EXPECT_NEAR((frame.tangent.cross(frame.bitangent) - n).length(), 0, 1e-5);
    }
}

}  // namespace
}  // namespace luxel
