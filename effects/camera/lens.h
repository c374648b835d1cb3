// Lenses: where the pixels of a distorted image look.
//
// A point (X, Y, Z) of the view frame (x right, y down, z forward) is projected to the pixel (fx x'' + cx, fy y'' +
// cy). A model of lenses gives (x'', y''), the place, in focal lengths from the principal point. The models are in
// effects/camera/lenses/, each with its formula and source.
//
// Each lens is one to one from the optical axis outwards up to a fold, an angle from the axis behind which a larger
// angle no longer gives a larger distance from the principal point, in some direction around the axis at least. Only
// directions before the fold are used.
//
// To add a model, add a file to effects/camera/lenses/ with its LensType, and declare that in lens_types.cpp. The
// attributes of all sensors with a lens, --describe, calibrations, messages and files follow.
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/frame_plan.h>

namespace simvis {

/// The largest angle from the optical axis that a fisheye shows.
inline constexpr double kFisheyeLimit_rad = 110 * std::numbers::pi / 180;

/// A lens without focal lengths and principal point.
///
/// Frames   V = view frame: x right, y down, z forward.
/// Units    places are in focal lengths from the principal point.
class LensModel {
 public:
  virtual ~LensModel() = default;

  /// Whether the lens shows a direction of V, of any length above 0. Only then may place() be called.
  virtual bool shows(const glm::dvec3& direction) const = 0;

  /// The place at which the lens shows a direction of V, of any length above 0.
  virtual glm::dvec2 place(const glm::dvec3& direction) const = 0;

  /// The direction that a place shows, V, unit length. Zero: it is more than kFisheyeLimit_rad off the axis.
  /// Empty: the place lies beyond the fold.
  virtual std::optional<glm::dvec3> direction(const glm::dvec2& place) const = 0;

  /// The distance from the principal point to the fold, computed from the radial part alone.
  virtual double reach() const = 0;
};

/// A model of lenses for the attribute `distortion`. Its strings and tables live as long as the program.
struct LensType {
  std::string_view name;      ///< the word of the attribute
  std::string_view ros_name;  ///< the distortion model in calibrations, messages and files
  /// The rows of its coefficients. They have no defaults: a coefficient that is not written is 0. Several models may
  /// have a row of one name, whose texts then differ and whose kind, unit and limits are equal.
  AttributeTable coefficients;
  /// The coefficients in the order of calibrations. Throws InputError at an attribute.
  std::vector<double> (*read)(const AttributeValues& attributes);
  /// Makes the lens with these coefficients. Null: the model has another number of coefficients.
  std::shared_ptr<const LensModel> (*create)(std::span<const double> coefficients);
  /// Returns the focal length in pixels that the coefficients determine. Null: fx and fy of the sensor say it.
  double (*focal_px)(std::span<const double> coefficients) = nullptr;
};

/// All models, in the order of the attribute's words.
std::span<const LensType* const> lens_types();

/// The model of a sensor with the attributes of lenses; null: it has none.
const LensType* lens_type_of(const AttributeValues& attributes);

/// For LensType::read of a model whose coefficients are those of its rows, in this order.
std::vector<double> numbers_of(AttributeTable coefficients, const AttributeValues& attributes);

class Lens {
 public:
  /// `pinhole`: pixels start at the corner of the first pixel, unlike OpenCV's (its centre). `model` is not null.
  Lens(const Pinhole& pinhole, std::shared_ptr<const LensModel> model);

  /// The pixel position of a direction that the lens shows.
  glm::dvec2 pixel(const glm::dvec3& direction) const;

  /// Whether pixel() may be called for the direction.
  bool shows(const glm::dvec3& direction) const { return model_->shows(direction); }

  /// The direction that a pixel shows, a unit vector; pixel() of it gives this pixel to 1e-9 pixels, and to the
  /// rounding of the direction where it hardly changes from pixel to pixel: near the fold of ftheta_backward and the
  /// pole of a rational_polynomial. Zero if the direction is more than kFisheyeLimit_rad off the axis. Empty if the
  /// pixel lies beyond the fold.
  std::optional<glm::dvec3> direction(const glm::dvec2& pixel) const;

 private:
  Pinhole pinhole_;
  std::shared_ptr<const LensModel> model_;
};

/// The lens of a calibration: `distortion_model` is its name in calibrations, with the coefficients in their order.
/// Empty: no LensType has this name with so many coefficients.
std::optional<Lens> lens_of(const Pinhole& pinhole, std::string_view distortion_model,
                            std::span<const double> coefficients);

}  // namespace simvis
