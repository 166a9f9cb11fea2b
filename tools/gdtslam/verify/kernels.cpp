#include "kernels.hpp"

#include <algorithm>
#include <atomic>
#include <map>

namespace gdtslam {
namespace {

std::atomic<std::uint64_t> g_decoy_calls{0};

void decoy_function(const CpuLaunch& /*launch*/) { ++g_decoy_calls; }

// Lives as long as the program, because a backend may keep references to kernels.
const KernelInfo& make_decoy(const KernelInfo& kernel) {
  static std::map<std::string_view, KernelInfo> decoys;
  KernelInfo& decoy = decoys.try_emplace(kernel.name, kernel).first->second;
  decoy.cpu.fill(decoy_function);
  return decoy;
}

bool does_nothing(const Extent& threads) { return threads.x == 0 || threads.y == 0 || threads.z == 0; }

CaseOutcome untouched(const KernelCase& kernel_case) {
  CaseOutcome outcome;
  for (const CaseBuffer& buffer : kernel_case.buffers) outcome.contents.push_back(buffer.content);
  return outcome;
}

std::uint64_t written_values(const KernelCase& kernel_case) {
  std::uint64_t values = 0;
  for (std::size_t i = 0; i < kernel_case.buffers.size(); ++i) {
    const ValueLayout& layout = kernel_case.buffers[i].layout;
    if (kernel_case.kernel->bindings[i] != Access::kRead) values += std::uint64_t{layout.width} * layout.height;
  }
  return values;
}

std::string place_text(const CaseDifference& difference) {
  return "buffer " + std::to_string(difference.binding) + " at (" + std::to_string(difference.x) + ", " +
         std::to_string(difference.y) + ")";
}

}  // namespace

KernelVerifier::KernelVerifier(Backend& reference, Backend& device, Proof proof)
    : reference_(reference), device_(device), proof_(proof) {}

KernelVerdict& KernelVerifier::find_verdict(const KernelInfo& kernel) {
  for (KernelVerdict& verdict : verdicts_) {
    if (verdict.kernel == kernel.name) return verdict;
  }
  verdicts_.emplace_back().kernel = kernel.name;
  return verdicts_.back();
}

void KernelVerifier::add_fault(const KernelCase& kernel_case, const std::string& what) {
  KernelVerdict& verdict = find_verdict(*kernel_case.kernel);
  ++verdict.faults;
  if (verdict.first.empty()) verdict.first = "'" + kernel_case.name + "': " + what;
}

void KernelVerifier::compare(const KernelCase& kernel_case, const CaseOutcome& expected, const CaseOutcome& found,
                             const std::string& how) {
  KernelVerdict& verdict = find_verdict(*kernel_case.kernel);
  if (const auto apart = difference(kernel_case, expected, found)) {
    verdict.different += apart->values;
    verdict.largest = std::max(verdict.largest, apart->largest);
    if (verdict.first.empty()) verdict.first = "'" + kernel_case.name + "'" + how + ": " + place_text(*apart);
  }
  if (!found.guards_intact) add_fault(kernel_case, "something was written behind a buffer" + how);
  if (!found.inputs_intact) add_fault(kernel_case, "an input was written" + how);
}

CaseOutcome KernelVerifier::run_on_device(const KernelCase& kernel_case) {
  const std::uint64_t cpu_calls = cpu_kernel_calls();
  const std::uint64_t dispatches = device_.dispatch_count();
  const std::uint64_t submissions = device_.submit_count();
  CaseOutcome outcome = run_case(device_, kernel_case);
  work_.dispatches += device_.dispatch_count() - dispatches;
  work_.submissions += device_.submit_count() - submissions;
  if (proof_ == Proof::kNone) return outcome;
  if (cpu_kernel_calls() != cpu_calls) add_fault(kernel_case, "a CPU kernel ran while the device should have worked");
  if (device_.dispatch_count() != dispatches + 1) add_fault(kernel_case, "the device did not count one dispatch");
  if (device_.submit_count() == submissions) add_fault(kernel_case, "nothing was submitted to the device");
  return outcome;
}

void KernelVerifier::try_decoy(KernelCase kernel_case, const CaseOutcome& expected) {
  proven_.emplace_back(kernel_case.kernel->name);
  const Buffer probe = device_.allocate(64);
  if (!device_.host_view(probe).empty()) add_fault(kernel_case, "the device's memory is the host's");
  kernel_case.kernel = &make_decoy(*kernel_case.kernel);
  const std::uint64_t calls = g_decoy_calls;
  const CaseOutcome found = run_on_device(kernel_case);
  if (g_decoy_calls != calls) add_fault(kernel_case, "the kernel's CPU function was called in place of its shader");
  if (g_decoy_calls == calls && !difference(kernel_case, expected, found)) ++work_.decoys;
  compare(kernel_case, expected, found, ", without its CPU functions");
}

void KernelVerifier::check(const KernelCase& kernel_case) {
  const CaseOutcome expected = run_case(reference_, kernel_case);
  KernelVerdict& verdict = find_verdict(*kernel_case.kernel);
  ++verdict.cases;
  verdict.values += written_values(kernel_case);
  compare(kernel_case, expected, run_on_device(kernel_case), "");
  if (proof_ == Proof::kNone || std::find(proven_.begin(), proven_.end(), kernel_case.kernel->name) != proven_.end()) {
    return;
  }
  // A decoy proves something only if doing nothing gives another result.
  if (!does_nothing(kernel_case.threads) && difference(kernel_case, untouched(kernel_case), expected)) {
    try_decoy(kernel_case, expected);
  }
}

void KernelVerifier::finish() {
  if (proof_ == Proof::kNone) return;
  for (KernelVerdict& verdict : verdicts_) {
    if (std::find(proven_.begin(), proven_.end(), verdict.kernel) != proven_.end()) continue;
    ++verdict.faults;
    if (verdict.first.empty()) verdict.first = "no case can show that the device ran it";
  }
}

}  // namespace gdtslam
