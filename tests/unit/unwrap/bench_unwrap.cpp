// Prints how long unwrapping takes for one large mesh: bench_unwrap [thousand triangles] [piece size] [threads].
// Meshes: a smooth sphere, a hilly terrain, a terrain with noise as high as half a quad, and triangles without
// neighbours.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "baker/core/parallel.h"
#include "baker/unwrap/unwrap.h"
#include "tests/unit/unwrap/made_scene.h"

namespace {

using namespace luxel;

test::MadeMesh loose_triangles(std::uint32_t count) {
    test::MadeMesh mesh;
    const auto random = [](std::uint64_t a, std::uint64_t b) { return static_cast<float>(mix(a, b) >> 40) * 0x1p-24f; };
    for (std::uint32_t t = 0; t < count; ++t) {
        const Vec3f centre(100 * random(t, 0), 100 * random(t, 1), 100 * random(t, 2));
        for (std::uint32_t k = 0; k < 3; ++k)
            mesh.positions.push_back(centre + Vec3f(random(t, 3 * k + 3), random(t, 3 * k + 4), random(t, 3 * k + 5)));
        mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    return mesh;
}

void run(const char* name, const test::MadeMesh& mesh, UnwrapOptions options) {
    Scene scene;
    test::add_object(scene, name, mesh, 1);
    std::vector<Warning> warnings;
    double area = 0;
    for (std::uint32_t t = 0; t < scene.triangle_count(); ++t) area += scene.area_m2(t);
    options.texels_per_metre = std::sqrt(4e6 / area);  // four million texels
    const std::clock_t cpu_start = std::clock();
    const auto start = std::chrono::steady_clock::now();
    const Atlas atlas = unwrap(scene, options, warnings, {});
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::printf("%-16s %7zu triangles %6zu charts %3u pages %6.2f s (%.2f s of all cores)  used %.0f %%\n", name,
                scene.triangle_count(), atlas.charts.size(), atlas.page_count, seconds.count(),
                double(std::clock() - cpu_start) / CLOCKS_PER_SEC,
                100 * 4e6 / (double(atlas.page_count) * atlas.page_size * atlas.page_size));
    for (const Warning& w : warnings) std::printf("    %s: %s\n", w.code.c_str(), w.text.c_str());
}

}  // namespace

int main(int argc, char** argv) {
    const double thousands = argc > 1 ? std::atof(argv[1]) : 640;
    UnwrapOptions options;
    if (argc > 2) options.piece_triangles = static_cast<std::uint32_t>(std::atoi(argv[2]));
    const ThreadLimit limit(argc > 3 ? static_cast<unsigned>(std::atoi(argv[3])) : 0);
    const auto triangles = static_cast<std::uint32_t>(thousands * 1000);
    const auto side = static_cast<std::uint32_t>(std::sqrt(triangles / 2.0));
    run("sphere", test::sphere(static_cast<std::uint32_t>(std::sqrt(triangles / 4.0)), 10), options);
    run("terrain", test::terrain(side, 0.1f, 0), options);
    run("noisy terrain", test::terrain(side, 0.1f, 0.5f), options);
    run("very noisy", test::terrain(side, 0.1f, 3.0f), options);
    run("loose triangles", loose_triangles(triangles), options);
}
