#include "baker/sweep/sweep_reference.h"

#include "baker/sweep/error_colour.h"
#include "formats/base/error.h"
#include "formats/base/file.h"

namespace luxel {

SweepReference::SweepReference(std::vector<std::filesystem::path> first, std::vector<std::filesystem::path> second, Key key, std::string name)
    : first_(std::move(first)), second_(std::move(second)), key_(key), name_(std::move(name)) {}

ReferencePage SweepReference::page(std::uint32_t number) const {
    ReferencePage page{read_page_light(first_.at(number)), {}};
    if (!second_.empty()) page.second = read_page_light(second_.at(number));
    return page;
}

SweepReference user_reference(const std::vector<std::filesystem::path>& pages) {
    KeyBuilder key("sweep reference 1");
    std::string name;
    for (const auto& path : pages) {
        key.bytes(read_file(path));
        name += (name.empty() ? "" : ", ") + path.filename().string();
    }
    return {pages, {}, key.finish(), name};
}

std::vector<std::filesystem::path> pages_of(const std::filesystem::path& model, std::uint64_t pages) {
    std::vector<std::filesystem::path> paths;
    for (std::uint32_t page = 0; page < pages; ++page) paths.push_back(page_path(model, page));
    return paths;
}

MeasuredBake measure_bake(const std::filesystem::path& model, std::uint64_t pages, bool has_error, const SweepReference& reference) {
    if (pages != reference.page_count())
        throw Error(ErrorCode::bad_input, "reference", "expected " + std::to_string(pages) + " pages as in the bake, found " + std::to_string(reference.page_count()),
                    "a reference has the layout of the bake: the same texels per metre, atlas size and padding; give --reference once for each page, in order");
    MeanLight mean;
    for (std::uint32_t page = 0; page < pages; ++page) {
        const ReferencePage truth = reference.page(page);
        const MeasuredPage found = read_measured_page(model, page, false);
        ErrorMeter::check(found, truth, page);
        mean.add(truth, found.area_m2);
    }
    ErrorMeter meter(mean.lux());
    for (std::uint32_t page = 0; page < pages; ++page) meter.add(read_measured_page(model, page, has_error), reference.page(page));
    return {meter.figures(), error_map_png(meter.maps())};
}

}  // namespace luxel
