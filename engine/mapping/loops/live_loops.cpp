#include "live_loops.hpp"

#include <chrono>
#include <system_error>
#include <utility>

#include "engine/core/memory/sparing.hpp"
#include "engine/core/scheduling.hpp"
#include "engine/core/side_thread.hpp"
#include "engine/core/signals_blocked.hpp"
#include "engine/mapping/map/keyframe_map.hpp"

namespace gdtslam {
namespace {

using namespace std::chrono_literals;

constexpr auto kBetweenProgress = 50ms;

}  // namespace

LiveLoops::LiveLoops(const LoopOptions& options, LiveOptions live)
    : live_(std::move(live)),
      counter_(options),
      measured_(live_.scratch_folder, live_.shelf_bytes),
      closer_(path_, options) {}

// Starts the thread with the first order, so that no thread exists if nothing is mapped.
void LiveLoops::start() {
  if (is_started_) return;
  is_started_ = true;
  if (live_.is_beside && start_thread()) return;
  is_over_ = true;
  live_.threads = 1;
}

bool LiveLoops::start_thread() {
  const SignalsBlocked blocked;
  try {
    thread_ = std::thread([this] { work(); });
    return true;
  } catch (const std::system_error& error) {
    if (live_.warn) {
      live_.warn(std::string("no thread to look for loops beside the mapping (") + error.what() +
                 "): it is done in between; the result is the same");
    }
    return false;
  }
}

void LiveLoops::take(Keyframe keyframe) {
  const bool is_place = counter_.is_place(keyframe.path_m);
  statistics_.places = counter_.places();
  hand_over(std::move(keyframe));
  if (is_place && counter_.places() > kPlacesLate) apply(counter_.places() - 1 - kPlacesLate);
}

std::shared_future<FrozenMap> LiveLoops::request_map(const MapperConfig& config) {
  MapRequest request{config, {}};
  std::shared_future<FrozenMap> map = request.promise.get_future().share();
  hand_over(std::move(request));
  return map;
}

std::shared_future<ClosedKeyframes> LiveLoops::request_keyframes() {
  KeyframesRequest request;
  std::shared_future<ClosedKeyframes> keyframes = request.get_future().share();
  hand_over(std::move(request));
  return keyframes;
}

// Without a thread the order is carried out here. After a failure the orders wait for abandon().
void LiveLoops::hand_over(Order order) {
  start();
  if (thread_.joinable() || failure_) {
    {
      const std::lock_guard lock(mutex_);
      orders_.push_back(std::move(order));
    }
    wake_.notify_one();
    return;
  }
  carry_out(order);
}

void LiveLoops::work() {
  run_in_background();
  std::unique_lock lock(mutex_);
  while (!is_abandoned_ && !failure_) {
    if (orders_.empty() && is_ending_) break;
    if (orders_.empty()) {
      wake_.wait(lock);
      continue;
    }
    Order order = std::move(orders_.front());
    orders_.pop_front();
    lock.unlock();
    carry_out(order);
    lock.lock();
    beside_cpu_s_ = own_cpu_s();
  }
  is_over_ = true;
  done_.notify_all();
}

void LiveLoops::carry_out(Order& order) {
  if (auto* const request = std::get_if<MapRequest>(&order)) {
    draw_map(*request);
    return;
  }
  if (auto* const request = std::get_if<KeyframesRequest>(&order)) {
    try {
      request->set_value({.T_map_base = closer_.carried_keyframes(), .T_closed_front = closer_.correction()});
    } catch (...) {
      request->set_exception(std::current_exception());
    }
    return;
  }
  try {
    follow(std::get<Keyframe>(order));
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
    done_.notify_all();
  }
}

void LiveLoops::append(Keyframe& keyframe) {
  path_.scans.push_back(std::move(keyframe.scan));
  push_sparingly(path_.poses, keyframe.T_map_base);
  push_sparingly(path_.path_m, keyframe.path_m);
  push_sparingly(path_.doubts, path_.doubts.empty() ? StepDoubt{} : step_doubt(keyframe.steps));
  path_.steps.push_back(keyframe.steps);
  measured_.put({keyframe.steps, keyframe.travel});
  is_pruned_.push_back(false);
}

// The next place is measured from the last one on.
void LiveLoops::forget_steps() {
  if (closer_.places().empty()) return;
  const std::size_t last = closer_.places().back();
  path_.steps.erase(path_.steps.begin(), path_.steps.begin() + static_cast<std::ptrdiff_t>(last - path_.first_step));
  path_.first_step = last;
}

void LiveLoops::recall_steps() {
  path_.steps.clear();
  path_.first_step = 0;
  path_.steps.reserve(measured_.size());
  path_.travels.reserve(measured_.size());
  Shelf<Measured>::Reader reader(measured_);
  while (path_.steps.size() < measured_.size()) {
    const Measured measured = reader.next();
    path_.steps.push_back(measured.steps);
    path_.travels.push_back(measured.travel);
  }
}

// Adds one keyframe and searches at one place at most.
void LiveLoops::follow(Keyframe& keyframe) {
  append(keyframe);
  if (!workers_) workers_ = std::make_unique<WorkerPool>(live_.threads);
  closer_.follow([](double, int) {}, *workers_);
  forget_steps();
  for (const std::size_t i : closer_.take_pruned()) {
    path_.scans.forget(i);
    is_pruned_[i] = true;
  }
  const std::lock_guard lock(mutex_);
  if (found_.size() == closer_.graph().poses.size()) return;
  push_sparingly(found_, closer_.correction());
  done_.notify_all();
}

void LiveLoops::draw_map(MapRequest& request) const {
  try {
    auto map = std::make_shared<SeparateMap>(request.config);
    const std::vector<Pose2> poses = closer_.carried_keyframes();
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (!is_pruned_[i]) map->merge(to_points(path_.scans[i]), poses[i]);
    }
    const GlobalField* const field = &map->field();
    request.promise.set_value(
        {.field = {std::move(map), field}, .keyframes = poses.size(), .T_closed_front = closer_.correction()});
  } catch (...) {
    request.promise.set_exception(std::current_exception());
  }
}

void LiveLoops::apply(std::size_t place) {
  std::unique_lock lock(mutex_);
  const auto is_there = [&] { return found_.size() > place || failure_; };
  if (!is_there()) {
    const auto since = std::chrono::steady_clock::now();
    done_.wait(lock, is_there);
    ++statistics_.waits;
    statistics_.waited_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - since).count();
  }
  if (found_.size() <= place) std::rethrow_exception(failure_);
  if (found_[place] == T_closed_front_) return;
  T_closed_front_ = found_[place];
  ++statistics_.corrections;
}

LoopCloser& LiveLoops::end(const std::function<void(double)>& progress) {
  std::unique_lock lock(mutex_);
  is_ending_ = true;
  wake_.notify_one();
  while (thread_.joinable() && !done_.wait_for(lock, kBetweenProgress, [this] { return is_over_; })) {
    const double share = static_cast<double>(found_.size() + 1) / static_cast<double>(counter_.places() + 1);
    lock.unlock();
    progress(share);
    lock.lock();
  }
  lock.unlock();
  join();
  if (failure_) std::rethrow_exception(failure_);
  recall_steps();
  return closer_;
}

void LiveLoops::abandon() {
  {
    const std::lock_guard lock(mutex_);
    is_abandoned_ = true;
  }
  wake_.notify_one();
  join();
  for (Order& order : orders_) {
    if (auto* const keyframe = std::get_if<Keyframe>(&order)) append(*keyframe);
  }
  orders_.clear();
}

void LiveLoops::join() {
  if (thread_.joinable()) thread_.join();
}

LiveStatistics LiveLoops::statistics() const {
  LiveStatistics statistics = statistics_;
  const std::lock_guard lock(mutex_);
  statistics.beside_cpu_s = beside_cpu_s_;
  return statistics;
}

}  // namespace gdtslam
