// Measurements that are not regular files, or that never end.
#include <gtest/gtest.h>

#include "tests/refused_inputs.h"

namespace palpate::tests {
namespace {

const Readers kReaders = {
    {"csv", {"fit", "FILE"}},
    {"csv", {"validate", "FILE", "--tissue", "liver"}},
    {"csv", {"validate", "--profile", "FILE", "--tissue", "liver", "--depth-mm", "5"}},
};

TEST(FitInputs, AFifoIsRefusedAtOnceByEveryReader) { expect_fifos_refused(kReaders); }

TEST(FitInputs, ADeviceWithoutEndIsRefusedByEveryReader) { expect_endless_devices_refused(kReaders); }

TEST(FitInputs, TwoGigabytesOfNothingAreRefusedByEveryReader) { expect_two_gigabytes_refused(kReaders); }

}  // namespace
}  // namespace palpate::tests
