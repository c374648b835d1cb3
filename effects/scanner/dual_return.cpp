#include "effects/scanner/dual_return.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "effects/scanner/range_law.h"

namespace simvis {
namespace {

constexpr double kNoReturn = std::numeric_limits<double>::quiet_NaN();

const TableColumn kDualReturnColumns[] = {
    {.name = kSecondRange,
     .format = "%.9g",
     .unit = "m",
     .meaning = "range of the last return, or of the second strongest if the strongest is the last",
     .nothing = kNoReturn},
    {.name = kSecondIntensity,
     .format = "%.9g",
     .unit = "1/m2",
     .meaning = "light of that return: reflectance x cosine / range^2",
     .nothing = kNoReturn}};

const ScanEffectRegistration kDualReturnRegistration(
    {.type = {.name = "dual_return",
              .summary = "A second return of each beam: the last, or the second strongest.",
              .notes =
                  "Adds the columns second_range_m and second_intensity, which are empty for beams with one return. "
                  "The second range has noise of its own and the same rounding as the first, and no bound. "
                  "Data packets of Velodyne devices then hold both returns.",
              .source = "attribute return=\"dual\"",
              .outputs = kShownInRanges,
              .reference = "VLP-16 User Manual, 63-9243, section 9.3.2",
              .needs = kCastsBeams},
     .order = ScanOrder::detection,
     .create = [](const ScanEffectContext& context) -> std::unique_ptr<ScanEffect> {
       if (context.attributes.choice("return") != "dual") return nullptr;
       return std::make_unique<DualReturn>(context);
     },
     .columns = kDualReturnColumns});

}  // namespace

const Echo* second_return(std::span<const Echo> echoes) {
  if (echoes.size() < 2) return nullptr;
  const auto strongest = std::ranges::max_element(echoes, {}, &Echo::power);
  if (&*strongest != &echoes.back()) return &echoes.back();
  return &*std::ranges::max_element(echoes.first(echoes.size() - 1), {}, &Echo::power);
}

DualReturn::DualReturn(const ScanEffectContext& context)
    : sigma_m_(context.attributes.number("range_noise")),
      sigma_rel_(context.attributes.number("range_noise_rel")),
      step_m_(context.attributes.number("range_resolution")),
      random_(context.random("dual_return")) {}

bool DualReturn::detect(const ScanContext&, std::uint32_t beam, std::span<const Echo> echoes, Echo&) const {
  if (beam >= second_.size()) second_.resize(beam + 1);
  const Echo* const second = second_return(echoes);
  second_[beam] = second != nullptr ? *second : Echo{};
  return false;
}

void DualReturn::finish(const ScanContext& context, std::span<const Echo>, Scan& scan) const {
  second_.resize(scan.range_m.size());  // another effect may have decided before detect()
  std::vector<double> ranges_m, intensities;
  for (std::uint32_t beam = 0; beam < scan.range_m.size(); ++beam) {
    const double range_m = second_[beam].range_m;
    if (std::isinf(range_m)) {
      ranges_m.push_back(kNoReturn);
      intensities.push_back(kNoReturn);
      continue;
    }
    const double gaussian = sigma_m_ > 0 || sigma_rel_ > 0 ? random_.gaussian(random_key(context.time), beam, 0) : 0;
    const double noisy_m = noisy_range_m(range_m, sigma_m_, sigma_rel_, gaussian);
    ranges_m.push_back(step_m_ > 0 ? rounded_range_m(noisy_m, step_m_) : noisy_m);
    intensities.push_back(second_[beam].power);
  }
  second_.clear();
  scan.add_channel(kDualReturnColumns[0], std::move(ranges_m));
  scan.add_channel(kDualReturnColumns[1], std::move(intensities));
}

}  // namespace simvis
