// Several image pairs at once: what one does not show, another may.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Metrics/MetricSum.h"
#include "Registration/CreasedDomain.h"
#include "Registration/Phantoms/Phantom.h"
#include "Registration/Registration.h"
#include "Testing/Registration/TestScenes.h"
#include "Testing/Transforms/SampleBases.h"

namespace crease {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr int kSize = 128;

/// How much a channel shows at a point of the moving image: nothing in one half.
double shown_right(const Point<2>& y) { return 1 / (1 + std::exp(-(y[0] - kSize / 2.0) / 3)); }
double shown_left(const Point<2>& y) { return 1 - shown_right(y); }

/// The phantom's images where the window shows them, grey elsewhere, with noise of their own.
Channel<2> seen_through(const Phantom& phantom, double (*window)(const Point<2>&), unsigned seed) {
  constexpr double kGrey = 0.5;
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 0.01);
  const auto seen = [&](const Image<float, 2>& image, const auto& to_moving) {
    Image<float, 2> result = image;
    for (std::int64_t k = 0; k < image.raster().num_samples(); ++k) {
      const auto [i, j] = image.index(k);
      const double shown = window(to_moving(image.raster().point({i, j})));
      float& value = result[{i, j}];
      value = static_cast<float>(kGrey + shown * (value - kGrey) + noise(random));
    }
    return result;
  };
  Channel<2> channel;
  channel.fixed = seen(phantom.fixed, phantom.truth);
  channel.moving = seen(phantom.moving, [](const Point<2>& y) { return y; });
  return channel;
}

Phantom clean_blobs() { return make_phantom("blobs", {.size = kSize, .noise = 0}); }

Registration<2> registration_of(const std::vector<Channel<2>>& channels) {
  Registration<2> registration(channels[0].fixed, channels[0].moving);
  registration.metric(channels[0].metric, channels[0].weight);
  for (std::size_t c = 1; c < channels.size(); ++c) registration.channel(channels[c]);
  const auto basis = testing::tensor_over<2>(channels[0].fixed.raster().bounds(), 8, 3);
  registration.basis(basis).initial({}).energy("bending", default_bending_weight(*basis),
                                               bending<2>());
  return registration;
}

double error_mm(const RegistrationResult<2>& result, const Phantom& phantom) {
  const auto found = [&](const Point<2>& x) { return result.transform->map(x); };
  return testing::rms_difference(phantom.fixed.raster(), found, phantom.truth, 12);
}

double registered_error(const std::vector<Channel<2>>& channels, const Phantom& phantom) {
  return error_mm(registration_of(channels).schedule({.adapt_weights = true}).run(), phantom);
}

double difference(const RegistrationResult<2>& a, const RegistrationResult<2>& b) {
  return (a.transform->parameters() - b.transform->parameters()).lpNorm<Eigen::Infinity>();
}

}  // namespace

// Each half of the motion is seen by one channel alone.
TEST(Channels, ShowTogetherWhatNeitherShowsAlone) {
  const Phantom phantom = clean_blobs();
  Channel<2> right = seen_through(phantom, shown_right, 1);
  Channel<2> left = seen_through(phantom, shown_left, 2);
  const double alone =
      std::min(registered_error({right}, phantom), registered_error({left}, phantom));
  EXPECT_GT(alone, 0.5);
  EXPECT_LT(registered_error({right, left}, phantom), 0.25);
  // Of different kinds, each under its own metric.
  for (float& v : left.moving.values()) v = std::sin(4 * v);
  left.metric = mutual_information<2>();
  EXPECT_LT(registered_error({right, left}, phantom), 0.5 * alone);
  EXPECT_LT(registered_error({left, right}, phantom), 0.5 * alone);
}

TEST(Channels, OfTheSameImagesAreOne) {
  const Phantom phantom = clean_blobs();
  const auto all = [](const Point<2>&) { return 1.0; };
  const Channel<2> once = seen_through(phantom, all, 3);
  const auto one = registration_of({once}).run();
  Channel<2> half = once;
  half.weight = 0.5;
  EXPECT_LT(difference(one, registration_of({half, half}).run()), 1e-4);
  Channel<2> nothing = seen_through(phantom, shown_left, 4);
  nothing.weight = 0;
  EXPECT_LT(difference(one, registration_of({once, nothing}).run()), 1e-4);
}

// Two metrics of one pair of images, as one metric or as two channels.
TEST(Channels, MayBeMetricsOfOnePair) {
  const Phantom phantom = clean_blobs();
  Channel<2> pair = seen_through(
      phantom, [](const Point<2>&) { return 1.0; }, 3);
  Channel<2> second = pair;
  second.metric = local_ncc<2>();
  const auto by_channels = registration_of({pair, second}).schedule({.adapt_weights = true}).run();
  pair.metric = [](const MetricInput<2>& input) {
    return std::make_unique<MetricSum<2>>(
        std::vector<MetricSum<2>::Channel>{{ssd<2>()(input), 1}, {local_ncc<2>()(input), 1}});
  };
  const auto by_sum = registration_of({pair}).schedule({.adapt_weights = true}).run();
  EXPECT_LT(error_mm(by_channels, phantom), 0.15);
  EXPECT_LT(error_mm(by_sum, phantom), 0.15);
  EXPECT_EQ(by_sum.channels.size(), 2);
  EXPECT_NEAR(by_sum.metric_before, by_channels.metric_before, 0.05 * by_sum.metric_before);
}

TEST(Channels, AreReportedEach) {
  const Phantom phantom = clean_blobs();
  Channel<2> right = seen_through(phantom, shown_right, 1);
  Channel<2> left = seen_through(phantom, shown_left, 2);
  left.metric = ncc<2>();
  left.weight = 3;
  const auto result = registration_of({right, left}).run();
  ASSERT_EQ(result.channels.size(), 2);
  EXPECT_EQ(result.channels[0].name, "ssd");
  EXPECT_EQ(result.channels[1].name, "ncc");
  EXPECT_EQ(result.channels[0].weight, 1);
  EXPECT_EQ(result.channels[1].weight, 3);
  for (const ChannelReport& channel : result.channels) {
    EXPECT_LT(channel.after, 0.5 * channel.before) << channel.name;
  }
  // The sum is in units of squared differences.
  const double of_left = result.metric_before - result.channels[0].before;
  EXPECT_NEAR((result.metric_after - result.channels[0].after) / of_left,
              result.channels[1].after / result.channels[1].before, 1e-9);
  EXPECT_GT(of_left, 0);
  const auto one = registration_of({right}).run();
  ASSERT_EQ(one.channels.size(), 1);
  EXPECT_EQ(one.channels[0].before, one.metric_before);
  EXPECT_EQ(one.channels[0].after, one.metric_after);
}

TEST(Channels, HaveTheSameBytesOnAnyNumberOfThreads) {
  const Phantom phantom = clean_blobs();
  Channel<2> right = seen_through(phantom, shown_right, 1);
  Channel<2> left = seen_through(phantom, shown_left, 2);
  left.metric = mutual_information<2>();
  const auto run = [&](int threads) {
    set_num_threads(threads);
    return registration_of({right, left}).schedule({.adapt_weights = true}).run();
  };
  const auto one = run(1);
  for (int threads : {2, 8}) EXPECT_EQ(difference(one, run(threads)), 0);
  set_num_threads(0);
}

// The second moving image has half the pixels, and a mask of its own.
TEST(Channels, MayHaveMovingImagesOnOtherGrids) {
  const Phantom phantom = clean_blobs();
  Channel<2> right = seen_through(phantom, shown_right, 1);
  Channel<2> left = seen_through(phantom, shown_left, 2);
  Raster<2> coarse;
  coarse.size = {kSize / 2, kSize / 2 + 3};
  coarse.spacing = {2, 2};
  coarse.origin = Point<2>(0.5, -0.5);
  Image<float, 2> moving(coarse);
  const auto interpolator = make_interpolator(left.moving);
  for (std::int64_t k = 0; k < coarse.num_samples(); ++k) {
    const auto [i, j] = moving.index(k);
    moving[{i, j}] = static_cast<float>(interpolator->evaluate(coarse.point({i, j})).value);
  }
  left.moving = moving;
  left.moving_mask = Mask<2>(coarse, std::vector<std::uint8_t>(moving.values().size(), 1));
  EXPECT_LT(registered_error({right, left}, phantom), 0.4);
}

// Stripes along x tell nothing of a shift along them, nor do stripes along y; so in space with three.
template <int Dim>
void expect_shift_of_stripes() {
  const auto raster = testing::raster_of<Dim>(Dim == 2 ? 80 : 32);
  Vector<Dim> shift = Vector<Dim>::Constant(1.7);
  shift[0] = -2.3;
  std::vector<Channel<Dim>> channels(Dim);
  for (int a = 0; a < Dim; ++a) {
    const auto stripes = [&](const Vector<Dim>& moved) {
      Image<float, Dim> image(raster);
      for (std::int64_t k = 0; k < raster.num_samples(); ++k) {
        const double x = image.index(k)[a] + moved[a];
        image.values()[static_cast<std::size_t>(k)] =
            static_cast<float>(100 * (a + 1) * (std::sin(0.3 * x) + 0.01 * x));
      }
      return image;
    };
    channels[a].fixed = stripes(shift);
    channels[a].moving = stripes(Vector<Dim>::Zero());
  }
  const auto found = align<Dim>(
      views(std::span<const Channel<Dim>>(channels)), {},
      {.start = AlignmentStart::kIdentity, .search = AlignmentSearch::kRigid, .try_angles = false});
  EXPECT_LT((found.map.offset - shift).norm(), 0.02) << Dim << "D";
  ASSERT_EQ(found.report.channels.size(), Dim);
  for (const ChannelReport& channel : found.report.channels) {
    EXPECT_LT(channel.after,
              0.1 * channel.before);  // what is left is beyond the moving image's border
  }

  Registration<Dim> registration(channels[0].fixed, channels[0].moving);
  for (int a = 1; a < Dim; ++a) registration.channel(channels[a]);
  const auto basis = testing::tensor_over<Dim>(raster.bounds(), 3, 3);
  const auto result = registration.basis(basis)
                          .initial({})
                          .energy("bending", default_bending_weight(*basis), bending<Dim>())
                          .run();
  const auto map = [&](const Point<Dim>& x) { return result.transform->map(x); };
  const auto truth = [&](const Point<Dim>& x) { return Point<Dim>(x + shift); };
  EXPECT_LT(testing::rms_difference(raster, map, truth, 6), 0.1) << Dim << "D";
}

TEST(Channels, OfStripesFindAShiftTogether) {
  expect_shift_of_stripes<2>();
  expect_shift_of_stripes<3>();
}

TEST(Channels, AreRefusedWhereTheyDoNotFit) {
  const Phantom phantom = clean_blobs();
  Channel<2> channel = seen_through(phantom, shown_right, 1);
  Registration<2> registration(channel.fixed, channel.moving);
  const auto refused = [&](const Channel<2>& second, const auto& why) {
    EXPECT_THAT([&] { registration.channel(second); }, ThrowsMessage<InvalidInput>(why));
  };
  Channel<2> bad = channel;
  Raster<2> raster = channel.fixed.raster();
  raster.spacing[0] = 2;
  bad.fixed = Image<float, 2>(raster, channel.fixed.values());
  refused(bad, AllOf(HasSubstr("channels 1 and 2 have different grids"), HasSubstr("of 1 x 1 mm"),
                     HasSubstr("of 2 x 1 mm")));
  bad = channel;
  bad.weight = -0.5;
  refused(bad, HasSubstr("channel 2 has the weight -0.5"));
  bad = channel;
  bad.moving = {};
  refused(bad, HasSubstr("channel 2: the moving image is empty"));
  bad = channel;
  bad.moving.values()[3] = NAN;
  refused(bad, HasSubstr("channel 2: the moving image"));
  EXPECT_THAT([&] { registration.metric(ssd<2>(), -1); },
              ThrowsMessage<InvalidInput>(HasSubstr("channel 1 has the weight -1")));
  EXPECT_THAT([&] { Registration<2>().channel(channel); },
              ThrowsMessage<InvalidInput>(HasSubstr("needs a first pair")));
}

}  // namespace crease
