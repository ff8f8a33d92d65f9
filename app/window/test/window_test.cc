#include "app/window/window.h"

#include <gtest/gtest.h>
TEST(A, B) { SUCCEED(); }
