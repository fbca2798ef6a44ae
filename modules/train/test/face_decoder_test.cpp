// The decoders of the papers' ablations against LibTorch's own modules and against central differences, in
// double; and the runtime against LibTorch.
#include "mien/models/face_decoder.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "mien/models/runtime_parameters.h"
#include "mien/train/torch_operations.h"
#include "mien/train/torch_parameters.h"

namespace mien::train {
namespace {

using torch::Tensor;
constexpr std::int64_t kInput = 5, kHidden = 8, kFeedback = 3, kFrames = 6;

Tensor noise(std::vector<std::int64_t> shape, std::uint64_t seed) {
  Tensor x = torch::empty(shape);
  NoiseField(seed, 0).normal(0, 0, {x.data_ptr<float>(), static_cast<std::size_t>(x.numel())});
  return x;
}

/// Random parameters, in double and with gradients.
template <class Network>
void fill(Network& network) {
  Initialise create(1);
  network.visit(create);
  std::uint64_t seed = 0;
  for (const auto& e : parameters(network))
    *e.slot = (0.4 * noise(e.slot->sizes().vec(), ++seed)).to(torch::kDouble).requires_grad_(true);
}

std::map<std::string, Tensor*> by_name(std::vector<Collect::Entry> entries) {
  std::map<std::string, Tensor*> slots;
  for (const auto& e : entries) slots[e.name] = e.slot;
  return slots;
}

double largest_difference(const Tensor& a, const Tensor& b) { return (a - b).abs().max().item<double>(); }

/// Copies our parameters into a module of LibTorch that has the same names; runs both; compares outputs and
/// gradients.
template <class Ours, class Theirs>
void expect_equals_module(Ours ours, Theirs theirs) {
  fill(ours);
  theirs->to(torch::kDouble);
  const auto slots = by_name(parameters(ours));
  {
    const torch::NoGradGuard no_grad;
    for (auto& p : theirs->named_parameters()) p.value().copy_(*slots.at(p.key()));
  }
  const Tensor x = noise({1, kFrames, kInput}, 77).to(torch::kDouble);
  const Tensor got = ours(x), want = std::get<0>(theirs->forward(x));
  EXPECT_LT(largest_difference(got, want), 1e-12);
  got.square().sum().backward();
  want.square().sum().backward();
  for (const auto& p : theirs->named_parameters())
    EXPECT_LT(largest_difference(slots.at(p.key())->grad(), p.value().grad()), 1e-10) << p.key();
}

TEST(Decoders, RecurrentLayersAreThoseOfLibTorch) {
  expect_equals_module(
      Rnn<Tensor>(kInput, kHidden, 2),
      torch::nn::RNN(torch::nn::RNNOptions(kInput, kHidden).num_layers(2).batch_first(true)));
  expect_equals_module(
      Lstm<Tensor>(kInput, kHidden, 2),
      torch::nn::LSTM(torch::nn::LSTMOptions(kInput, kHidden).num_layers(2).batch_first(true)));
  expect_equals_module(
      Gru<Tensor>(kInput, kHidden, 2),
      torch::nn::GRU(torch::nn::GRUOptions(kInput, kHidden).num_layers(2).batch_first(true)));
}

// Our layer's parameters as TransformerDecoderLayer has them: queries, keys and values in one matrix.
void copy_attention(const MultiHeadAttention<Tensor>& ours, torch::nn::MultiheadAttention& theirs) {
  theirs->in_proj_weight.copy_(torch::cat({ours.q_proj.weight, ours.k_proj.weight, ours.v_proj.weight}));
  theirs->in_proj_bias.copy_(torch::cat({ours.q_proj.bias, ours.k_proj.bias, ours.v_proj.bias}));
  theirs->out_proj->weight.copy_(ours.out_proj.weight);
  theirs->out_proj->bias.copy_(ours.out_proj.bias);
}
void copy_linear(const Linear<Tensor>& ours, torch::nn::Linear& theirs) {
  theirs->weight.copy_(ours.weight);
  theirs->bias.copy_(ours.bias);
}
void copy_norm(const LayerNorm<Tensor>& ours, torch::nn::LayerNorm& theirs) {
  theirs->weight.copy_(ours.gamma);
  theirs->bias.copy_(ours.beta);
}

TEST(Decoders, TransformerLayersAreThoseOfLibTorch) {
  TransformerDecoder<Tensor> ours(kInput, kFeedback, kHidden, 2, 2);
  fill(ours);
  const torch::NoGradGuard no_grad;
  const Tensor memory = noise({1, kFrames, kInput}, 7).to(torch::kDouble),
               rows = noise({1, kFrames, kFeedback}, 8).to(torch::kDouble);
  auto state = ours.begin(memory);
  const Tensor got = ours.next(rows, state);

  // LibTorch has time before the batch.
  const Tensor positions = sinusoid_rows(memory, 0, kFrames, kHidden);
  const Tensor seen = (ours.memory_map(memory) + positions).transpose(0, 1);
  Tensor h = (ours.feedback_map(rows) + positions).transpose(0, 1);
  const Tensor later = torch::zeros({kFrames, kFrames}, torch::kDouble)
                           .masked_fill(torch::triu(torch::ones({kFrames, kFrames}), 1).to(torch::kBool),
                                        -std::numeric_limits<double>::infinity());
  for (auto& layer : ours.layers) {
    torch::nn::TransformerDecoderLayer theirs(
        torch::nn::TransformerDecoderLayerOptions(kHidden, 2).dim_feedforward(layer.inner).dropout(0));
    theirs->to(torch::kDouble);
    copy_attention(layer.self_attn, theirs->self_attn);
    copy_attention(layer.multihead_attn, theirs->multihead_attn);
    copy_linear(layer.linear1, theirs->linear1);
    copy_linear(layer.linear2, theirs->linear2);
    copy_norm(layer.norm1, theirs->norm1);
    copy_norm(layer.norm2, theirs->norm2);
    copy_norm(layer.norm3, theirs->norm3);
    h = theirs->forward(h, seen, later);
  }
  EXPECT_LT(largest_difference(got, h.transpose(0, 1)), 1e-12);
}

/// A decoder with the last layer that a head has.
struct Head {
  explicit Head(DecoderKind kind)
      : decoder(DecoderSizes{.kind = kind, .num_layers = 2, .heads = 2}, kInput, kHidden, kFeedback) {
    fill(*this);
  }
  FaceDecoder<Tensor> decoder;
  Linear<Tensor> out{kHidden, kFeedback};
  template <class V>
  void visit(V& v) {
    decoder.visit_as("gru", v);
    v.scope("out", out);
  }
  [[nodiscard]] Tensor loss(const Tensor& tokens, const Tensor* written) const {
    DecoderPass<Tensor> pass;
    pass.written = written;
    return decoder(tokens, out, pass).square().sum();
  }
};

constexpr DecoderKind kKinds[] = {DecoderKind::gru, DecoderKind::rnn, DecoderKind::lstm,
                                  DecoderKind::transformer};

TEST(Decoders, GradientsAreCentralDifferences) {
  const Tensor tokens = noise({1, kFrames, kInput}, 5).to(torch::kDouble),
               written = noise({1, kFrames, kFeedback}, 6).to(torch::kDouble);
  for (const DecoderKind kind : kKinds)
    for (const Tensor* forced : {static_cast<const Tensor*>(nullptr), &written}) {
      SCOPED_TRACE(std::string(decoder_kind_name(kind)) + (forced != nullptr ? " forced" : ""));
      Head head(kind);
      head.loss(tokens, forced).backward();
      const torch::NoGradGuard no_grad;
      for (const auto& e : parameters(head)) {
        double* values = e.slot->data_ptr<double>();
        for (std::int64_t i = 0; i < e.slot->numel(); i += std::max<std::int64_t>(1, e.slot->numel() / 3)) {
          constexpr double kStep = 1e-5;
          const double before = values[i];
          values[i] = before + kStep;
          const double above = head.loss(tokens, forced).item<double>();
          values[i] = before - kStep;
          const double below = head.loss(tokens, forced).item<double>();
          values[i] = before;
          const double got = e.slot->grad().view({-1})[i].item<double>();
          EXPECT_NEAR(got, (above - below) / (2 * kStep), 1e-6 * std::max(1.0, std::abs(got))) << e.name;
        }
      }
    }
}

TEST(Decoders, TheRuntimeGivesWhatLibTorchGives) {
  const auto path = std::filesystem::path(testing::TempDir()) /
                    ("mien_decoder_" + std::to_string(getpid()) + ".safetensors");
  const Tensor tokens = noise({1, kFrames, kInput}, 5);
  for (const DecoderKind kind : kKinds) {
    SCOPED_TRACE(decoder_kind_name(kind));
    Head head(kind);
    for (const auto& e : parameters(head)) *e.slot = e.slot->detach().to(torch::kFloat);
    ASSERT_TRUE(save_parameters(parameters(head), path, false, {}));
    const auto file = SafetensorsFile::open(path);
    ASSERT_TRUE(file);
    std::map<std::string, Shape> shapes;
    for (const auto& t : file->tensors()) shapes[t.name] = t.shape;
    const auto stored = stored_decoder(shapes);
    ASSERT_TRUE(stored);
    EXPECT_EQ(stored->sizes.kind, kind);
    EXPECT_EQ(stored->sizes.num_layers, 2);
    EXPECT_EQ(stored->input, kInput);
    EXPECT_EQ(stored->hidden, kHidden);

    FaceDecoder<mien::Tensor> decoder(head.decoder.sizes, kInput, kHidden, kFeedback);
    Linear<mien::Tensor> out{kHidden, kFeedback};
    LoadRuntime load(*file);
    decoder.visit_as("gru", load);
    load.scope("out", out);
    const auto loaded = load.finish();
    ASSERT_TRUE(loaded) << loaded.error().message();
    const mien::Tensor got = decoder(
        mien::Tensor({kFrames, kInput}, {tokens.data_ptr<float>(), static_cast<std::size_t>(tokens.numel())}),
        out);
    const torch::NoGradGuard no_grad;
    const Tensor want = head.decoder(tokens, head.out).contiguous();
    for (std::int64_t i = 0; i < want.numel(); ++i)
      EXPECT_NEAR(got.data()[i], want.data_ptr<float>()[i], 2e-5) << i;
  }
  std::filesystem::remove(path);
}

TEST(Decoders, NoFramesGiveNoFrames) {
  for (const DecoderKind kind : kKinds) {
    if (kind == DecoderKind::gru) continue;  // LibTorch's refuses; training never has such a clip
    const Head head(kind);
    EXPECT_EQ(head.decoder(torch::empty({1, 0, kInput}, torch::kDouble), head.out).sizes(),
              (std::vector<std::int64_t>{1, 0, kFeedback}))
        << decoder_kind_name(kind);
  }
}

}  // namespace
}  // namespace mien::train
