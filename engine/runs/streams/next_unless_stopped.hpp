// A signal may cut an input anywhere: in the middle of a line, or before the topics that were named.
#pragma once

#include <functional>

#include "gdtslam/core/error.hpp"
#include "gdtslam/io/log.hpp"

namespace gdtslam {

/// The next of what `source` gives. Where `stop` says so, what a reader complains of is the end.
template <class Source>
auto next_unless_stopped(Source& source, const std::function<bool()>& stop) {
  try {
    return source.next();
  } catch (const InputError&) {
    if (!stop()) throw;
  } catch (const MissingTopic&) {
    if (!stop()) throw;
  }
  return decltype(source.next())();
}

}  // namespace gdtslam
