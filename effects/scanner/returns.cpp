#include "effects/scanner/returns.h"

#include <algorithm>
#include <cmath>

namespace simvis {
namespace {

constexpr double kReflectanceRounding = 0x1p-24;

Echo merged(std::span<const Echo> echoes) {
  double power = 0, largest_error_m = 0, weight_error = kReflectanceRounding, within_cone_m = 0;
  for (const Echo& echo : echoes) {
    power += echo.power;
    largest_error_m = std::max(largest_error_m, echo.error_bound_m);
    weight_error = std::max(weight_error, kReflectanceRounding + 2 * echo.error_bound_m / echo.range_m);
    within_cone_m = std::max(within_cone_m, echo.within_cone_m);
  }
  if (within_cone_m > 0) weight_error = 1;
  const double nearest_m = echoes.front().range_m, spread_m = echoes.back().range_m - nearest_m;
  const bool even = !(power > 0) || std::isinf(power);
  double t_min_m = 0;
  for (const Echo& echo : echoes) {
    t_min_m += (even ? 1 / static_cast<double>(echoes.size()) : echo.power / power) * (echo.range_m - nearest_m);
  }
  return {.range_m = nearest_m + std::min(t_min_m, spread_m),
          .error_bound_m = largest_error_m + weight_error * spread_m + within_cone_m,
          .power = power};
}

constexpr AttributeSpec kReturnsAttributes[] = {
    {.name = "return",
     .kind = AttributeKind::choice,
     .default_value = "strongest",
     .text = "the return that is reported; dual: the strongest, and a second one in columns of its own",
     .choices = "strongest first last dual"},
    {.name = "pulse_length",
     .unit = "m",
     .text = "c T / 2 of a pulse of duration T; echoes closer than this are one return; default: 0.75",
     .min = 0},
};

const TableColumn kReturnsColumns[] = {
    {.name = "return_count", .format = "%.0f", .meaning = "number of returns of the beam"}};

std::unique_ptr<ScanEffect> create_returns(const ScanEffectContext& context) {
  const AttributeValues& a = context.attributes;
  const std::string& choice = a.choice("return");
  if (choice == "strongest" && !a.is_set("pulse_length")) return nullptr;
  return std::make_unique<Returns>(choice == "first"  ? ReturnChoice::first
                                   : choice == "last" ? ReturnChoice::last
                                                      : ReturnChoice::strongest,
                                   a.is_set("pulse_length") ? a.number("pulse_length") : kPulseLength_m);
}

const ScanEffectRegistration kReturnsRegistration(
    {.type = {.name = "returns",
              .summary = "First, last or strongest return of a beam, and how many there are.",
              .notes = "Adds the column return_count. Echoes without a gap of one pulse length are one return, at "
                       "their mean range weighted by power. Without this effect a scan reports the strongest return, "
                       "with pulses of 0.75 m (5 ns).",
              .source = "attribute return first, last or dual, or pulse_length",
              .outputs = kShownInRanges,
              .reference = "overlapping echoes are one pulse: c T / 2; its range the mean, weighted by power",
              .needs = kCastsBeams,
              .attributes = kReturnsAttributes},
     .order = ScanOrder::detection,
     .create = create_returns,
     .columns = kReturnsColumns});

}  // namespace

void merge_pulses(double pulse_length_m, std::vector<Echo>& echoes) {
  std::size_t pulses = 0;
  for (std::size_t first = 0, end = 0; first < echoes.size(); first = end) {
    for (end = first + 1; end < echoes.size(); ++end) {
      if (echoes[end].range_m - echoes[end - 1].range_m > pulse_length_m) break;
    }
    echoes[pulses++] = merged(std::span(echoes).subspan(first, end - first));
  }
  echoes.resize(pulses);
}

bool Returns::detect(const ScanContext&, std::uint32_t, std::span<const Echo> echoes, Echo& detected) const {
  if (echoes.empty()) return false;
  detected = choice_ == ReturnChoice::first  ? echoes.front()
             : choice_ == ReturnChoice::last ? echoes.back()
                                             : *std::ranges::max_element(echoes, {}, &Echo::power);
  detected.returns = static_cast<std::uint32_t>(echoes.size());
  return true;
}

void Returns::finish(const ScanContext& context, std::span<const Echo> detected, Scan& scan) const {
  std::vector<double> counts;
  for (const Echo& echo : detected) counts.push_back(echo.range_m > context.range_max_m ? 0 : echo.returns);
  scan.add_channel(kReturnsColumns[0], std::move(counts));
}

}  // namespace simvis
