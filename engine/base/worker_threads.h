// Threads that wait for work, for work that takes less time than starting one.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace simvis {

class WorkerThreads {
 public:
  using Work = std::function<void(std::size_t thread, std::size_t first, std::size_t count)>;

  WorkerThreads() = default;
  ~WorkerThreads();
  WorkerThreads(const WorkerThreads&) = delete;
  WorkerThreads& operator=(const WorkerThreads&) = delete;

  /// As many as there are cores, the caller's own thread among them.
  static std::size_t count();

  /// Divides `things` into pieces, of `piece` each but for the last, among all threads; this one is number 0. Returns
  /// when all is done; what a thread has thrown is thrown here. Threads are started when there is first enough for two.
  void share(std::size_t things, std::size_t piece, const Work& work);

 private:
  void start();
  void serve(std::size_t thread);
  void work_on_pieces(std::size_t thread);

  struct Job {
    const Work* work = nullptr;
    std::size_t things = 0, piece = 0;
  } job_;
  std::atomic<std::size_t> next_{0};          // the first thing that nobody has taken
  std::atomic<std::uint32_t> number_{0};      // of the job
  std::atomic<std::uint32_t> unfinished_{0};  // threads that still work on it
  std::atomic<bool> stopped_{false};
  std::mutex failed_;
  std::exception_ptr failure_;
  std::vector<std::jthread> threads_;
};

}  // namespace simvis
