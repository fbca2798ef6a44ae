#pragma once
#include <torch/torch.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "mien/base/progress.h"
#include "mien/base/result.h"
#include "mien/train/torch_parameters.h"

namespace mien::train {

/// How one stage of a training runs.
struct StageOptions {
  std::int64_t num_steps = 1000;
  double learning_rate = 1e-3;  ///< after warm-up
  bool falling_rate = true;     ///< along a cosine to 1 % at the last step; else the rate stays
  std::int64_t warm_up_steps = 100;
  bool starts_at_zero = false;  ///< warm-up: step s of S has the share s / S of the rate; else (s + 1) / S
  double beta1 = 0.9, beta2 = 0.98;
  double epsilon = 1e-8;        ///< added to the root of the second moment; ProbTalk3D: 1e-9
  double weight_decay = 0.02;   ///< decoupled (AdamW, Loshchilov and Hutter 2019); matrices only
  bool decays_vectors = false;  ///< norms and biases, too
  double clip_norm = 1.0;       ///< of the gradient of all parameters together; 0: not clipped
  /// Of the exponential average of the weights, which is what a stage delivers; 0: it delivers the weights.
  double average_decay = 0.999;
  /// The loss itself changes parameters that are not trained (running statistics of batch norms): they belong
  /// to the checkpoint.
  bool keeps_buffers = false;
  std::int64_t checkpoint_every = 500;

  /// Adam (Kingma and Ba 2015) at one rate, and nothing else: how the published systems were trained.
  static StageOptions plain_adam(std::int64_t num_steps, double rate) {
    return {.num_steps = num_steps,
            .learning_rate = rate,
            .falling_rate = false,
            .warm_up_steps = 0,
            .beta2 = 0.999,
            .weight_decay = 0,
            .clip_norm = 0,
            .average_decay = 0};
  }
  /// AdamW with PyTorch's defaults, a warm-up from zero and an average of the weights: how SAiD's authors
  /// train (specification of SAiD, sections 7.3 and 7.5).
  static StageOptions warm_adamw(std::int64_t num_steps, double rate, std::int64_t warm_up_steps,
                                 double average_decay) {
    return {.num_steps = num_steps,
            .learning_rate = rate,
            .falling_rate = false,
            .warm_up_steps = warm_up_steps,
            .starts_at_zero = true,
            .beta2 = 0.999,
            .weight_decay = 0.01,
            .decays_vectors = true,
            .clip_norm = 1.0,
            .average_decay = average_decay};
  }
};

/// Reported after each step.
struct StepReport {
  std::int64_t step = 0;
  double loss = 0, learning_rate = 0, gradient_norm = 0;
  /// Runs `work` while the parameters hold their exponential average (themselves, where there is none): to
  /// validate or write what the stage would deliver if it ended here.
  std::function<void(const std::function<void()>& work)> with_average{};
};

/// Minimises `loss(step)` over the trained parameters of `entries`, in order of steps. The state is saved to
/// `checkpoint` every `checkpoint_every` steps and at the end; when the file exists, the stage goes on from
/// it and gives the same losses as without the interruption, provided that loss(step) draws all its
/// randomness from the step. An undefined loss ends the stage early. A parameter rests until a loss first
/// depends on it. On success the parameters hold their exponential average (if there is one) and need no
/// gradient any more.
///
/// Errors: Errc::cancelled after progress.cancel() (a checkpoint is kept), Errc::failed when the loss is not
/// finite; those of loss().
Status run_stage(const std::string& name, const std::vector<Collect::Entry>& entries,
                 const StageOptions& options, const std::filesystem::path& checkpoint,
                 const std::function<Result<torch::Tensor>(std::int64_t)>& loss, Progress& progress,
                 const std::function<void(const StepReport&)>& report);

/// Copies the averaged weights of a checkpoint of run_stage (its weights, when no average is kept) into the
/// network: what the stage would deliver if it ended there. Returns its step. Errors: not a checkpoint of
/// these parameters (incompatible).
Result<std::int64_t> load_stage_average(const std::vector<Collect::Entry>& entries,
                                        const std::filesystem::path& checkpoint);

}  // namespace mien::train
