// Everything that knows oneDNN, versions 2 and 3.
#include <omp.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <oneapi/dnnl/dnnl.hpp>
#include <tuple>
#include <vector>

#include "backends.h"
#include "elementwise_dispatch.h"

namespace mien {
namespace {

using Type = dnnl::memory::data_type;
using Layout = dnnl::memory::format_tag;

const dnnl::engine& engine() {
  static const dnnl::engine e(dnnl::engine::kind::cpu, 0);
  return e;
}

struct Types {
  Type input, weights, output;
};

Types types_of(Backend backend) {
  if (backend == Backend::onednn_bf16) return {Type::bf16, Type::bf16, Type::f32};
  if (backend == Backend::onednn_int8) return {Type::s8, Type::s8, Type::s32};
  return {Type::f32, Type::f32, Type::f32};
}

/// [M, K] times [K, N]; oneDNN chooses the layout of the weights.
dnnl::matmul::primitive_desc describe(const Types& types, std::int64_t m, std::int64_t k, std::int64_t n,
                                      std::int64_t x_stride, bool has_bias) {
  const dnnl::memory::desc x({m, k}, types.input, {x_stride, 1});
  const dnnl::memory::desc w({k, n}, types.weights, Layout::any);
  const dnnl::memory::desc y({m, n}, types.output, Layout::ab);
  const dnnl::memory::desc b({1, n}, Type::f32, Layout::ab);
  dnnl::primitive_attr attributes;
  attributes.set_scratchpad_mode(dnnl::scratchpad_mode::user);  // so that threads may share a primitive
#if DNNL_VERSION_MAJOR >= 3
  if (has_bias) return {engine(), x, w, b, y, attributes};
  return {engine(), x, w, y, attributes};
#else
  if (has_bias) return {dnnl::matmul::desc(x, w, b, y), attributes, engine()};
  return {dnnl::matmul::desc(x, w, y), attributes, engine()};
#endif
}

dnnl::memory over(const dnnl::memory::desc& desc, const void* data) {
  return {desc, engine(),
          const_cast<void*>(data)};  // the interface has no constant memory; inputs are only read
}

/// The number of threads oneDNN may use, for the time of a scope.
class Threads {
 public:
  explicit Threads(int count) : before_(omp_get_max_threads()) { omp_set_num_threads(std::max(count, 1)); }
  ~Threads() { omp_set_num_threads(before_); }
  Threads(const Threads&) = delete;
  Threads& operator=(const Threads&) = delete;

 private:
  int before_;
};

class OnednnKernel final : public PackedMatrix::Kernel {
 public:
  OnednnKernel(const float* weights, std::int64_t num_outputs, std::int64_t num_inputs, Backend backend)
      : num_outputs_(num_outputs), num_inputs_(num_inputs), backend_(backend), types_(types_of(backend)) {
    const auto count = static_cast<std::size_t>(num_outputs * num_inputs);
    if (backend == Backend::onednn_int8) {
      plain_.resize(count);
      weight_steps_.resize(static_cast<std::size_t>(num_outputs));
      for (std::int64_t n = 0; n < num_outputs; ++n)
        weight_steps_[static_cast<std::size_t>(n)] =
            kernels_.quantise_row(weights + n * num_inputs, num_inputs,
                                  reinterpret_cast<std::int8_t*>(plain_.data()) + n * num_inputs);
    } else {
      plain_.resize(count * sizeof(float));
      std::memcpy(plain_.data(), weights, plain_.size());
    }
  }

  void run(const View& x, const float* bias, float* y, int num_threads) const override {
    const Threads threads(num_threads);
    switch (backend_) {
      case Backend::onednn_bf16:
        return run_bf16(x, bias, y, num_threads);
      case Backend::onednn_int8:
        return run_int8(x, bias, y, num_threads);
      default:
        return run_f32(x, bias, y, num_threads);
    }
  }

 private:
  struct Plan {
    dnnl::matmul::primitive_desc desc;
    dnnl::matmul primitive;
    dnnl::memory weights;
  };

  /// Whether rows begin within the one before, as those of a convolution do. oneDNN takes no such rows.
  [[nodiscard]] bool overlap(const View& x) const { return x.rows > 1 && x.stride < num_inputs_; }

  void run_f32(const View& x, const float* bias, float* y, int num_threads) const {
    if (!overlap(x)) return execute(x.rows, x.stride, x.data, bias, y, num_threads);
    AlignedFloats apart(x.rows * num_inputs_);
    for (std::int64_t m = 0; m < x.rows; ++m)
      std::copy_n(x.data + m * x.stride, num_inputs_, apart.get() + m * num_inputs_);
    execute(x.rows, num_inputs_, apart.get(), bias, y, num_threads);
  }

  void run_bf16(const View& x, const float* bias, float* y, int num_threads) const {
    const auto narrow =
        std::make_unique_for_overwrite<std::uint16_t[]>(static_cast<std::size_t>(x.rows * num_inputs_));
    if (overlap(x)) {  // each value is rounded once, then copied
      const std::int64_t count = (x.rows - 1) * x.stride + num_inputs_;
      const auto once = std::make_unique_for_overwrite<std::uint16_t[]>(static_cast<std::size_t>(count));
      kernels_.round_to_bfloat16(x.data, once.get(), count);
      for (std::int64_t m = 0; m < x.rows; ++m)
        std::copy_n(once.get() + m * x.stride, num_inputs_, narrow.get() + m * num_inputs_);
    } else {
      for (std::int64_t m = 0; m < x.rows; ++m)
        kernels_.round_to_bfloat16(x.data + m * x.stride, narrow.get() + m * num_inputs_, num_inputs_);
    }
    execute(x.rows, num_inputs_, narrow.get(), bias, y, num_threads);
  }

  void run_int8(const View& x, const float* bias, float* y, int num_threads) const {
    const auto rows = static_cast<std::size_t>(x.rows);
    const auto narrow =
        std::make_unique_for_overwrite<std::int8_t[]>(static_cast<std::size_t>(x.rows * num_inputs_));
    const auto steps = std::make_unique_for_overwrite<float[]>(rows);
    for (std::size_t m = 0; m < rows; ++m) {
      const auto row = static_cast<std::int64_t>(m);
      steps[m] =
          kernels_.quantise_row(x.data + row * x.stride, num_inputs_, narrow.get() + row * num_inputs_);
    }
    const auto sums =
        std::make_unique_for_overwrite<std::int32_t[]>(static_cast<std::size_t>(x.rows * num_outputs_));
    execute(x.rows, num_inputs_, narrow.get(), nullptr, sums.get(), num_threads);
    for (std::int64_t m = 0; m < x.rows; ++m)
      kernels_.dequantise_row(sums.get() + m * num_outputs_, steps[static_cast<std::size_t>(m)],
                              weight_steps_.data(), bias, num_outputs_, y + m * num_outputs_);
  }

  void execute(std::int64_t rows, std::int64_t x_stride, const void* x, const float* bias, void* y,
               int num_threads) const {
    const Plan plan = plan_for(rows, x_stride, bias != nullptr, num_threads);
    const auto scratch_desc = plan.desc.scratchpad_desc();
    const auto scratch = std::make_unique_for_overwrite<std::byte[]>(scratch_desc.get_size() + 64);
    const auto address = reinterpret_cast<std::uintptr_t>(scratch.get());
    dnnl::stream stream(engine());
    std::unordered_map<int, dnnl::memory> arguments{
        {DNNL_ARG_SRC, over(plan.desc.src_desc(), x)},
        {DNNL_ARG_WEIGHTS, plan.weights},
        {DNNL_ARG_DST, over(plan.desc.dst_desc(), y)},
        {DNNL_ARG_SCRATCHPAD, over(scratch_desc, scratch.get() + (64 - address % 64) % 64)}};
    if (bias != nullptr) arguments.insert({DNNL_ARG_BIAS, over(plan.desc.bias_desc(), bias)});
    plan.primitive.execute(stream, arguments);
    stream.wait();
  }

  /// oneDNN compiles a product for exact sizes, so plans are kept; handles inside are shared, copies are
  /// cheap.
  Plan plan_for(std::int64_t rows, std::int64_t x_stride, bool has_bias, int num_threads) const {
    const std::lock_guard lock(mutex_);
    const auto key = std::tuple(rows, x_stride, has_bias, num_threads);
    if (const auto found = plans_.find(key); found != plans_.end()) return found->second;
    if (plans_.size() >= kMaxPlans) plans_.clear();
    auto desc = describe(types_, rows, num_inputs_, num_outputs_, x_stride, has_bias);
    const Plan plan{desc, dnnl::matmul(desc), weights_in(desc.weights_desc())};
    return plans_.emplace(key, plan).first->second;
  }

  /// The weights in the layout that a plan asks for: different sizes mostly ask for the same.
  dnnl::memory weights_in(const dnnl::memory::desc& layout) const {
    for (const auto& [known, memory] : weights_)
      if (known == layout) return memory;
    // Stored as [N, K]: the [K, N] of oneDNN seen the other way round.
    const Type stored = backend_ == Backend::onednn_int8 ? Type::s8 : Type::f32;
    const auto from = over({{num_inputs_, num_outputs_}, stored, Layout::ba}, plain_.data());
    dnnl::memory to(layout, engine());
    dnnl::stream stream(engine());
    dnnl::reorder(from, to).execute(stream, const_cast<dnnl::memory&>(from), to);
    stream.wait();
    weights_.emplace_back(layout, to);
    return to;
  }

  static constexpr std::size_t kMaxPlans = 64;
  std::int64_t num_outputs_, num_inputs_;
  Backend backend_;
  Types types_;
  const elementwise::Kernels& kernels_ = elementwise::best_kernels();
  std::vector<std::byte> plain_;     ///< [N, K] float32, or int8
  std::vector<float> weight_steps_;  ///< [N], int8 only
  mutable std::mutex mutex_;
  mutable std::map<std::tuple<std::int64_t, std::int64_t, bool, int>, Plan> plans_;
  mutable std::vector<std::pair<dnnl::memory::desc, dnnl::memory>> weights_;
};

bool try_plan(Backend backend) {
  try {
    describe(types_of(backend), 2, 32, 32, 32, false);
    return true;
  } catch (const dnnl::error&) {
    return false;  // e.g. bfloat16 on a processor without AVX-512
  }
}

}  // namespace

KernelPtr make_onednn_kernel(const float* weights, std::int64_t num_outputs, std::int64_t num_inputs,
                             Backend backend) {
  return std::make_shared<OnednnKernel>(weights, num_outputs, num_inputs, backend);
}

bool onednn_available(Backend backend) {
  static const bool f32 = try_plan(Backend::onednn);
  static const bool bf16 = try_plan(Backend::onednn_bf16);
  static const bool int8 = try_plan(Backend::onednn_int8);
  return backend == Backend::onednn_bf16 ? bf16 : backend == Backend::onednn_int8 ? int8 : f32;
}

}  // namespace mien
