// The protocol of the page, `simvis.live.v1`: what its clients share, and one client.
//
// A client gets the difference between the frame that it has seen last and the latest one, whenever it can take it, and
// the latest measurement of each sensor that it looks at. It can take a frame while fewer than kMaxUnshown of those
// that were sent to it are not shown yet: a browser reads all that comes, however slowly it draws, so that frames would
// wait there without end. Nothing is lost of what is answered to it.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "program/live/control.h"
#include "program/live/server.h"
#include "program/live/text_queue.h"
#include "program/live/view_encoder.h"
#include "program/live/view_snapshot.h"

namespace simvis::live {

class ViewPeer;

/// Frames under way to a client: one that it shows, and one that comes meanwhile.
inline constexpr std::size_t kMaxUnshown = 2;

/// All but viewers() and can_show() is of the server's thread.
class ViewHub {
 public:
  /// `wanted` is called when clients look at something else.
  ViewHub(ControlQueue& controls, std::function<void(ViewWants)> wanted);

  /// Clients, and those of them that can take a frame now. Any thread.
  std::size_t viewers() const { return viewers_; }
  std::size_t can_show() const { return can_show_; }

  std::unique_ptr<Peer> connect(ClientId client);
  void publish(ViewFrame frame, const ViewTime& time);
  /// How the simulation runs has changed, and no frame has been made.
  void set_time(const ViewTime& time);
  void answer_error(ClientId client, std::string_view about, std::string_view message);
  void answer_all_error(std::string_view about, std::string_view message);
  void answer_saved(ClientId client, std::string_view xml);
  /// The scene of this structure as a GLB; null: it is none of the last ones.
  std::shared_ptr<const std::string> glb(std::uint64_t structure);

 private:
  friend class ViewPeer;
  // The sensor, and the name of the image; empty: a scan.
  using Output = std::pair<std::uint32_t, std::string>;
  struct Measured {
    std::uint64_t order = 0;
    std::optional<ViewScan> scan;
    std::optional<ViewImage> image;
    std::shared_ptr<const std::string> message;  // made when a client first needs it
  };
  const std::shared_ptr<const std::string>& message_of(Measured& measured);
  void keep_measurements(ViewFrame& frame);
  void follow_wants();

  ControlQueue& controls_;
  std::function<void(ViewWants)> wanted_;
  std::atomic<std::size_t> viewers_ = 0, can_show_ = 0;
  std::shared_ptr<const ViewFrame> frame_;  // the latest
  ViewTime time_;
  std::uint64_t time_order_ = 0;
  std::map<Output, Measured> measured_;
  std::uint64_t next_order_ = 1;
  std::deque<std::shared_ptr<const ViewScene>> scenes_;  // the last ones: a page may have heard of one and load it yet
  std::shared_ptr<const std::string> glb_;
  std::uint64_t glb_structure_ = 0;
  std::map<ClientId, ViewPeer*> peers_;
};

class ViewPeer : public Peer {
 public:
  ViewPeer(ViewHub& hub, ClientId id);
  ~ViewPeer() override;
  void receive(std::string_view message, bool binary) override;
  std::optional<WireMessage> next() override;

 private:
  friend class ViewHub;
  void add(bool binary, std::string bytes);
  void follow_frame();
  void look(const std::set<std::uint32_t>& sensors);
  void sent();
  void shown();
  void request(Control control);

  ViewHub& hub_;
  ClientId id_;
  TextQueue texts_;
  std::deque<WireMessage> waiting_;  // that bring the client to `seen_`
  std::shared_ptr<const ViewFrame> seen_;
  std::uint64_t seen_time_ = 0;
  std::size_t unshown_ = 0;
  std::map<ViewHub::Output, std::uint64_t> sent_;
  std::set<std::string> looks_at_;
  bool wants_plan_ = false, wants_physics_ = false, pulls_ = false;
  std::uint64_t bodies_of_ = 0;  // structure of the scene whose bodies it knows; 0: none
};

}  // namespace simvis::live
