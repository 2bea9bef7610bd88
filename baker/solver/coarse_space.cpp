#include "baker/solver/coarse_space.h"

#include <Eigen/SparseCholesky>
#include <cmath>

#include "baker/core/parallel.h"
#include "formats/base/error.h"

namespace luxel {
namespace {

/// Of a vector that others of its chunk hold already but for this share, the rest is not worth a place.
constexpr double smallest_rest = 1e-3;
/// A pivot of the model below this is rounding: light that never ends, as far as can be told.
constexpr double smallest_pivot = 1e-10;

using Sparse = Eigen::SparseMatrix<double>;

}  // namespace

CoarseSpace::CoarseSpace(const Transport& transport)
    : transport_(transport), of_chunk_(transport.layout().chunk_count()), place_in_(of_chunk_.size()) {
    // Rows are in the order of the other chunk, so that places are met in order.
    std::vector<std::size_t> next(of_chunk_.size(), 0);
    for (ChunkNumber chunk = 0; chunk < of_chunk_.size(); ++chunk)
        for (const RowBlock& block : transport.row(chunk)) place_in_[chunk].push_back(next[block.other]++);
}

std::uint64_t CoarseSpace::entries_of(ChunkNumber chunk) const {
    std::uint64_t entries = 2 * std::uint64_t{transport_.size(chunk)};
    const std::span<const RowBlock> row = transport_.row(chunk);
    for (std::size_t place = 0; place < row.size(); ++place)
        if (of_chunk_[chunk].empty())
            entries += std::min<std::uint64_t>(transport_.size(row[place].other),
                                               transport_.blocks()[row[place].index].pair_count);
        else  // the same patches as by its first vector, which is light from everywhere
            entries += vectors_[of_chunk_[chunk][0]].columns[place].rows.size();
    return entries;
}

std::size_t CoarseSpace::room_for(ChunkNumber chunk) const {
    const std::uint64_t patches = transport_.layout().patch_count(), most = most_entries(patches);
    if (!of_chunk_[chunk].empty())
        return std::max<std::size_t>(most * transport_.size(chunk) / (patches * entries_of(chunk)), 1);
    // The first vector: as large as the others are, or as it can be.
    const std::uint64_t expected = vectors_.empty() ? entries_of(chunk) : entries_ / vectors_.size();
    if (entries_ + expected > most) return 0;
    return std::max<std::size_t>(most * transport_.size(chunk) / (patches * expected), 1);
}

/// P_u^T (A / rho' - G) P_v of two vectors of one chunk.
Channels CoarseSpace::inside(const Vector& u, const Vector& v) const {
    const PatchNumber first = transport_.first(u.chunk);
    Channels sum{0, 0, 0};
    for (std::size_t i = 0; i < u.radiosity.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const PatchNumber patch = first + static_cast<PatchNumber>(i);
            const double reflect = transport_.scaled_reflectance(patch)[c];
            if (reflect > 0)
                sum[c] += u.radiosity[i][c] * (transport_.area_m2(patch) / reflect * v.radiosity[i][c] - v.own[i][c]);
        }
    return sum;
}

bool CoarseSpace::make_orthonormal(Vector& vector) const {
    const Channels before = inside(vector, vector);
    const auto subtract = [&](const Vector& u, const Channels& share) {
        for (std::size_t i = 0; i < vector.radiosity.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) {
                vector.radiosity[i][c] -= share[c] * u.radiosity[i][c];
                vector.own[i][c] -= share[c] * u.own[i][c];
            }
    };
    for (int pass = 0; pass < 2; ++pass)  // twice is enough: Kahan, Parlett
        for (const std::size_t u : of_chunk_[vector.chunk]) subtract(vectors_[u], inside(vectors_[u], vector));
    const Channels after = inside(vector, vector);
    bool any = false;
    for (std::size_t c = 0; c < 3; ++c) {
        const bool good =
            after[c] > 0 && std::isfinite(after[c]) && after[c] > smallest_rest * smallest_rest * before[c];
        const double scale = good ? 1 / std::sqrt(after[c]) : 0.0;
        any = any || good;
        for (std::size_t i = 0; i < vector.radiosity.size(); ++i) {
            vector.radiosity[i][c] = good ? vector.radiosity[i][c] * scale : 0.0;
            vector.own[i][c] = good ? vector.own[i][c] * scale : 0.0;
        }
    }
    return any;
}

std::optional<std::size_t> CoarseSpace::add(ChunkNumber chunk, std::span<const Lanes> radiosity,
                                            std::span<const Lanes> own) {
    Vector vector;
    vector.chunk = chunk;
    vector.columns.resize(transport_.row(chunk).size());
    for (std::size_t i = 0; i < radiosity.size(); ++i) {
        vector.radiosity.push_back({radiosity[i].v[0], radiosity[i].v[1], radiosity[i].v[2]});
        vector.own.push_back({own[i].v[0], own[i].v[1], own[i].v[2]});
    }
    if (!make_orthonormal(vector)) return std::nullopt;
    of_chunk_[chunk].push_back(vectors_.size());
    vectors_.push_back(std::move(vector));
    return vectors_.size() - 1;
}

std::vector<Lanes> CoarseSpace::radiosity(std::size_t number) const {
    std::vector<Lanes> lanes;
    for (const Channels& value : vectors_[number].radiosity) lanes.push_back({{value[0], value[1], value[2], 0}});
    return lanes;
}

void CoarseSpace::set_column(std::size_t vector, std::size_t place, std::span<const Lanes> exchange) {
    Column& column = vectors_[vector].columns[place];
    for (std::size_t i = 0; i < exchange.size(); ++i) {
        const auto& v = exchange[i].v;
        if (v[0] == 0 && v[1] == 0 && v[2] == 0) continue;
        column.rows.push_back(static_cast<std::uint16_t>(i));
        column.exchange.push_back({v[0], v[1], v[2]});
    }
    column.rows.shrink_to_fit();
    column.exchange.shrink_to_fit();
}

void CoarseSpace::finish(std::size_t number) {
    const Vector& vector = vectors_[number];
    entries_ += 2 * vector.radiosity.size();
    const std::span<const RowBlock> row = transport_.row(vector.chunk);
    for (std::size_t place = 0; place < row.size(); ++place) {
        const Column& column = vector.columns[place];
        entries_ += column.rows.size();
        for (const std::size_t u : of_chunk_[row[place].other]) {
            if (u > number) continue;  // it will see this one
            Channels sum{0, 0, 0};
            for (std::size_t k = 0; k < column.rows.size(); ++k)
                for (std::size_t c = 0; c < 3; ++c)
                    sum[c] -= vectors_[u].radiosity[column.rows[k]][c] * column.exchange[k][c];
            couplings_.push_back({u, number, sum});
        }
    }
}

/// P^T (A / rho') U per vector.
std::vector<Channels> CoarseSpace::moments(std::span<const Channels> unshot) const {
    std::vector<Channels> moments(vectors_.size(), {0, 0, 0});
    parallel_for(vectors_.size(), 1, [&](std::size_t v) {
        const Vector& vector = vectors_[v];
        const PatchNumber first = transport_.first(vector.chunk);
        for (std::size_t i = 0; i < vector.radiosity.size(); ++i) {
            const PatchNumber patch = first + static_cast<PatchNumber>(i);
            const double area_m2 = transport_.area_m2(patch);
            const Channels& reflect = transport_.scaled_reflectance(patch);
            for (std::size_t c = 0; c < 3; ++c)
                if (reflect[c] > 0) moments[v][c] += vector.radiosity[i][c] * area_m2 / reflect[c] * unshot[patch][c];
        }
    });
    return moments;
}

/// `levels`: the moments on entry.
bool CoarseSpace::solve(std::size_t c, std::vector<Channels>& levels) const {
    const auto size = static_cast<Eigen::Index>(vectors_.size());
    std::vector<Eigen::Triplet<double>> lower;
    for (const Coupling& k : couplings_)
        lower.emplace_back(static_cast<int>(std::max(k.u, k.v)), static_cast<int>(std::min(k.u, k.v)), k.value[c]);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
    for (std::size_t v = 0; v < vectors_.size(); ++v) {
        lower.emplace_back(static_cast<int>(v), static_cast<int>(v), 1.0);  // vectors of one chunk are orthonormal
        right(static_cast<Eigen::Index>(v)) = levels[v][c];
    }
    Sparse matrix(size, size);
    matrix.setFromTriplets(lower.begin(), lower.end());
    const Eigen::SimplicialLDLT<Sparse> factors(matrix);
    if (factors.info() != Eigen::Success || !(factors.vectorD().minCoeff() > smallest_pivot)) return false;
    const Eigen::VectorXd solution = factors.solve(right);
    for (std::size_t v = 0; v < vectors_.size(); ++v) levels[v][c] = solution(static_cast<Eigen::Index>(v));
    return solution.allFinite();
}

std::vector<Channels> CoarseSpace::solve(std::vector<Channels> moments) const {
    if (vectors_.empty()) return {};
    for (std::size_t c = 0; c < 3; ++c)
        if (!solve(c, moments)) return {};
    return moments;
}

std::vector<Channels> CoarseSpace::levels(std::span<const Channels> unshot) const { return solve(moments(unshot)); }

std::vector<Channels> CoarseSpace::deflation(std::span<const Channels> unshot) const {
    std::vector<Channels> rest = moments(unshot);
    parallel_for(vectors_.size(), 1, [&](std::size_t v) {
        const Vector& vector = vectors_[v];
        const PatchNumber first = transport_.first(vector.chunk);
        for (std::size_t i = 0; i < vector.own.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) rest[v][c] -= vector.own[i][c] * unshot[first + i][c];
        for (std::size_t place = 0; place < vector.columns.size(); ++place) {
            const Column& column = vector.columns[place];
            const PatchNumber other = transport_.first(transport_.row(vector.chunk)[place].other);
            for (std::size_t k = 0; k < column.rows.size(); ++k)
                for (std::size_t c = 0; c < 3; ++c)
                    rest[v][c] -= column.exchange[k][c] * unshot[other + column.rows[k]][c];
        }
    });
    return solve(std::move(rest));
}

void CoarseSpace::send(std::span<const Channels> levels, std::span<Channels> irradiance,
                       std::span<Channels> unshot) const {
    parallel_for(of_chunk_.size(), 1, [&](std::size_t k) {
        const auto chunk = static_cast<ChunkNumber>(k);
        const Exchange sums = exchange(chunk, levels);
        for (std::size_t i = 0; i < sums.sent.size(); ++i) {
            const PatchNumber patch = transport_.first(chunk) + static_cast<PatchNumber>(i);
            for (std::size_t c = 0; c < 3; ++c) {
                const double received = sums.received[i][c] / transport_.area_m2(patch);
                irradiance[patch][c] += received;
                unshot[patch][c] += transport_.scaled_reflectance(patch)[c] * received - sums.sent[i][c];
            }
        }
    });
}

CoarseSpace::Exchange CoarseSpace::exchange(ChunkNumber chunk, std::span<const Channels> levels) const {
    Exchange sum{std::vector<Channels>(transport_.size(chunk)), std::vector<Channels>(transport_.size(chunk))};
    for (const std::size_t v : of_chunk_[chunk])
        for (std::size_t i = 0; i < sum.sent.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) {
                sum.sent[i][c] += levels[v][c] * vectors_[v].radiosity[i][c];
                sum.received[i][c] += levels[v][c] * vectors_[v].own[i][c];
            }
    const std::span<const RowBlock> row = transport_.row(chunk);
    for (std::size_t place = 0; place < row.size(); ++place)
        for (const std::size_t v : of_chunk_[row[place].other]) {
            const Column& column = vectors_[v].columns[place_in_[chunk][place]];
            for (std::size_t k = 0; k < column.rows.size(); ++k)
                for (std::size_t c = 0; c < 3; ++c)
                    sum.received[column.rows[k]][c] += levels[v][c] * column.exchange[k][c];
        }
    return sum;
}

std::vector<double> CoarseSpace::save() const {
    // Large next to everything else of a solve: never more than once in memory.
    std::size_t count = 0;
    for (const Vector& vector : vectors_) {
        count += 1 + 3 * (vector.radiosity.size() + vector.own.size());
        for (const Column& column : vector.columns) count += 1 + column.rows.size() + 3 * column.exchange.size();
    }
    std::vector<double> numbers;
    numbers.reserve(count);
    const auto put = [&](std::span<const Channels> values) {
        for (const Channels& value : values) numbers.insert(numbers.end(), value.begin(), value.end());
    };
    for (const Vector& vector : vectors_) {
        numbers.push_back(vector.chunk);
        put(vector.radiosity);
        put(vector.own);
        for (const Column& column : vector.columns) {
            numbers.push_back(static_cast<double>(column.rows.size()));
            numbers.insert(numbers.end(), column.rows.begin(), column.rows.end());
            put(column.exchange);
        }
    }
    return numbers;
}

void CoarseSpace::restore(std::span<const double> numbers) {
    std::size_t at = 0;
    const auto take = [&](std::size_t count) {
        if (count > numbers.size() - at)
            throw Error(ErrorCode::internal, "saved solve", "it ends inside a vector of the coarse model");
        at += count;
        return numbers.subspan(at - count, count);
    };
    const auto whole = [&](double limit) {
        const double value = take(1)[0];
        if (!(value >= 0 && value < limit && value == std::floor(value)))
            throw Error(ErrorCode::internal, "saved solve",
                        "found " + std::to_string(value) + " where a whole number is expected");
        return static_cast<std::uint32_t>(value);
    };
    const auto channels = [&](std::size_t count) {
        std::vector<Channels> values(count);
        const std::span<const double> flat = take(3 * count);
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t c = 0; c < 3; ++c) values[i][c] = flat[3 * i + c];
        return values;
    };
    while (at < numbers.size()) {
        Vector vector;
        vector.chunk = whole(static_cast<double>(of_chunk_.size()));
        vector.radiosity = channels(transport_.size(vector.chunk));
        vector.own = channels(transport_.size(vector.chunk));
        for (const RowBlock& block : transport_.row(vector.chunk)) {
            Column& column = vector.columns.emplace_back();
            const std::uint32_t rows = whole(transport_.size(block.other) + 1.0);
            for (std::uint32_t k = 0; k < rows; ++k)
                column.rows.push_back(static_cast<std::uint16_t>(whole(transport_.size(block.other))));
            column.exchange = channels(rows);
        }
        of_chunk_[vector.chunk].push_back(vectors_.size());
        vectors_.push_back(std::move(vector));
        finish(vectors_.size() - 1);
    }
}

}  // namespace luxel
