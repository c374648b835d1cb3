#include "bench/scan_curves/coin_peers.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/gl.h>
#include <Inventor/SbViewportRegion.h>
#include <Inventor/SoPickedPoint.h>
#include <Inventor/actions/SoGLRenderAction.h>
#include <Inventor/actions/SoRayPickAction.h>
#include <Inventor/nodes/SoPerspectiveCamera.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <stdexcept>

#include "bench/scan_curves/coin_scene.h"

namespace simvis::bench {

namespace {

constexpr double kQuarter = std::numbers::pi / 2;
constexpr double kNear_m = 0.05, kFar_m = 80;  // of both methods: the default limits of a SimVis scanner
constexpr int kUntilCached = 3;                // frames in which Coin may still create its drawing caches
constexpr float kNothing = std::numeric_limits<float>::infinity();

/// An OpenGL context with a depth buffer and no window.
class OffScreen {
 public:
  OffScreen(int width_px, int height_px) {
    const auto get_display =
        reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
    if (get_display != nullptr) display_ = get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_DEPTH_SIZE, 24,
                             EGL_NONE};
    const EGLint size[] = {EGL_WIDTH, width_px, EGL_HEIGHT, height_px, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint configs = 0;
    const bool there = eglInitialize(display_, nullptr, nullptr) == EGL_TRUE &&
                       eglBindAPI(EGL_OPENGL_API) == EGL_TRUE &&
                       eglChooseConfig(display_, wanted, &config, 1, &configs) == EGL_TRUE && configs == 1;
    if (there) {
      context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, nullptr);
      surface_ = eglCreatePbufferSurface(display_, config, size);
    }
    if (!there || eglMakeCurrent(display_, surface_, surface_, context_) != EGL_TRUE) {
      throw std::runtime_error("there is no OpenGL off screen");
    }
  }
  ~OffScreen() {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroySurface(display_, surface_);
    eglDestroyContext(display_, context_);
  }
  OffScreen(const OffScreen&) = delete;
  OffScreen& operator=(const OffScreen&) = delete;

 private:
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
  EGLSurface surface_ = EGL_NO_SURFACE;
};

SoPerspectiveCamera* camera_at(const glm::dmat4& world_from_sensor, double azimuth, int width_px) {
  const glm::dmat3 turn(world_from_sensor);
  const glm::dvec3 forward = turn * glm::dvec3(std::cos(azimuth), std::sin(azimuth), 0);
  const glm::dvec3 up = turn * glm::dvec3(0, 0, 1), right = glm::cross(forward, up);
  SbMatrix axes = SbMatrix::identity();
  for (int i = 0; i < 3; ++i) {
    axes[0][i] = static_cast<float>(right[i]);
    axes[1][i] = static_cast<float>(up[i]);
    axes[2][i] = static_cast<float>(-forward[i]);
  }
  auto* const camera = new SoPerspectiveCamera;
  camera->viewportMapping = SoCamera::LEAVE_ALONE;
  camera->position = to_coin(glm::dvec3(world_from_sensor[3]));
  camera->orientation = SbRotation(axes);
  camera->aspectRatio = static_cast<float>(width_px);
  camera->heightAngle = static_cast<float>(2 * std::atan(1.0 / width_px));  // 90 degrees wide, one row high
  camera->nearDistance = kNear_m;
  camera->farDistance = kFar_m;
  return camera;
}

/// The paper's method: each view is one row of a depth buffer.
class DepthViews {
 public:
  DepthViews(const CoinScene& scene, const std::vector<PeerScan>& scans) {
    for (const PeerScan& scan : scans) {
      const auto [low, high] = std::ranges::minmax(scan.azimuth_rad);
      const int views = std::max(1, static_cast<int>(std::ceil((high - low) / kQuarter - 1e-9)));
      const auto width_px = static_cast<int>(scan.azimuth_rad.size());
      width_px_ = std::max(width_px_, width_px);
      for (int v = 0; v < views; ++v) {
        const double middle = (low + high) / 2 + kQuarter * (v - (views - 1) / 2.0);
        SoSeparator* const view = new SoSeparator;
        view->ref();
        view->renderCaching = SoSeparator::OFF;
        view->addChild(camera_at(scan.world_from_sensor, middle, width_px));
        view->addChild(scene.get());
        roots_.emplace_back(view);
        regions_.emplace_back(static_cast<short>(width_px), short{1});
        regions_.back().setViewportPixels(0, static_cast<short>(roots_.size() - 1), static_cast<short>(width_px), 1);
      }
      add_beams(scan, (low + high) / 2, views, roots_.size() - static_cast<std::size_t>(views), width_px);
    }
    screen_ = std::make_unique<OffScreen>(width_px_, static_cast<int>(roots_.size()));
    for (SbViewportRegion& region : regions_) {
      const SbVec2s origin = region.getViewportOriginPixels(), size = region.getViewportSizePixels();
      region.setWindowSize(static_cast<short>(width_px_), static_cast<short>(roots_.size()));
      region.setViewportPixels(origin, size);
    }
    action_ = std::make_unique<SoGLRenderAction>(regions_.front());
    depth_.resize(static_cast<std::size_t>(width_px_) * roots_.size());
    ranges_m_.resize(beams_.size());
  }

  void measure() {
    glEnable(GL_DEPTH_TEST);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    for (std::size_t v = 0; v < roots_.size(); ++v) {
      action_->setViewportRegion(regions_[v]);
      action_->apply(roots_[v].get());
    }
    glReadPixels(0, 0, width_px_, static_cast<int>(roots_.size()), GL_DEPTH_COMPONENT, GL_FLOAT, depth_.data());
    for (std::size_t i = 0; i < beams_.size(); ++i) {
      const double d = depth_[beams_[i].pixel];
      const double z_m = kNear_m * kFar_m / (kFar_m - d * (kFar_m - kNear_m));
      ranges_m_[i] = d < 1 ? static_cast<float>(z_m * beams_[i].range_per_depth) : kNothing;
    }
  }

  const std::vector<float>& ranges_m() const { return ranges_m_; }

 private:
  struct Beam {
    std::size_t pixel;
    double range_per_depth;
  };

  void add_beams(const PeerScan& scan, double middle, int views, std::size_t first_view, int width_px) {
    for (const double azimuth : scan.azimuth_rad) {
      const double from_first = (azimuth - middle) / kQuarter + views / 2.0;
      const int view = std::clamp(static_cast<int>(from_first), 0, views - 1);
      const double angle = (from_first - view - 0.5) * kQuarter;
      const int column = std::clamp(static_cast<int>((1 - std::tan(angle)) / 2 * width_px), 0, width_px - 1);
      // Rows are as wide as the widest scan; here all scans have the same width.
      beams_.push_back({(first_view + static_cast<std::size_t>(view)) * static_cast<std::size_t>(width_px) +
                            static_cast<std::size_t>(column),
                        1 / std::cos(angle)});
    }
  }

  std::vector<CoinScene> roots_;
  std::vector<SbViewportRegion> regions_;
  std::vector<Beam> beams_;
  int width_px_ = 0;
  std::unique_ptr<OffScreen> screen_;
  std::unique_ptr<SoGLRenderAction> action_;
  std::vector<float> depth_, ranges_m_;
};

std::vector<float> pick(const CoinScene& scene, const std::vector<PeerScan>& scans) {
  std::vector<float> ranges_m;
  SoRayPickAction ray(SbViewportRegion(1, 1));
  for (const PeerScan& scan : scans) {
    const glm::dvec3 origin(scan.world_from_sensor[3]);
    for (const glm::dvec3& direction : scan.directions) {
      ray.setRay(to_coin(origin), to_coin(glm::dmat3(scan.world_from_sensor) * direction), kNear_m, kFar_m);
      ray.apply(scene.get());
      const SoPickedPoint* const point = ray.getPickedPoint();
      ranges_m.push_back(point == nullptr ? kNothing : (point->getPoint() - to_coin(origin)).length());
    }
  }
  return ranges_m;
}

}  // namespace

std::vector<Method> coin_methods(const DrawList& list, const std::vector<PeerScan>& scans) {
  const auto scene = std::make_shared<CoinScene>(make_coin_scene(list));
  const auto views = std::make_shared<DepthViews>(*scene, scans);
  for (int i = 0; i < kUntilCached; ++i) views->measure();
  const auto picked = std::make_shared<std::vector<float>>();
  std::vector<Method> methods;
  methods.push_back({.name = "coin depth",
                     .max_error_rel = {},
                     .threads = 2,
                     .set = [scene, views] { views->measure(); },
                     .ranges_m = [views] { return views->ranges_m(); }});
  methods.push_back({.name = "coin pick",
                     .max_error_rel = {},
                     .threads = 1,
                     .set = [scene, scans, picked] { *picked = pick(*scene, scans); },
                     .ranges_m = [picked] { return *picked; }});
  return methods;
}

}  // namespace simvis::bench
