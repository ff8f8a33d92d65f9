// Keys, buttons and text for the panels, without a display.
#include "app/window/input_queue.h"

#include <gtest/gtest.h>

namespace palpate::app {
namespace {

SDL_KeyboardEvent key(SDL_Keycode which, SDL_Scancode code, bool down, Uint16 modifiers = KMOD_NONE) {
  SDL_KeyboardEvent event{};
  event.type = down ? SDL_KEYDOWN : SDL_KEYUP;
  event.keysym.sym = which;
  event.keysym.scancode = code;
  event.keysym.mod = modifiers;
  return event;
}

void tap(InputQueue& queue, SDL_Keycode which, SDL_Scancode code, Uint16 modifiers = KMOD_NONE) {
  queue.add_key(key(which, code, true, modifiers));
  queue.add_key(key(which, code, false, modifiers));
}

TEST(InputQueue, ATapWithinOneFrameIsHeldForOneFrame) {
  InputQueue queue;
  EXPECT_TRUE(queue.next().keys.none());
  tap(queue, SDLK_ESCAPE, SDL_SCANCODE_ESCAPE);
  EXPECT_TRUE(queue.next().keys[SDL_SCANCODE_ESCAPE]);
  EXPECT_FALSE(queue.next().keys[SDL_SCANCODE_ESCAPE]);
  EXPECT_TRUE(queue.next().keys.none());
}

TEST(InputQueue, TwoTapsWithinOneFrameAreTwoPresses) {
  InputQueue queue;
  tap(queue, SDLK_DOWN, SDL_SCANCODE_DOWN);
  tap(queue, SDLK_DOWN, SDL_SCANCODE_DOWN);
  for (const bool held : {true, false, true, false}) {
    EXPECT_EQ(queue.next().keys[SDL_SCANCODE_DOWN], held);
  }
}

TEST(InputQueue, ADoubleClickWithinOneFrameIsTwoClicks) {
  InputQueue queue;
  for (const bool down : {true, false, true, false}) queue.add_button(0, down);
  for (const bool held : {true, false, true, false}) EXPECT_EQ(queue.next().buttons[0], held);
}

TEST(InputQueue, CtrlIsHeldInTheFrameOfItsKey) {
  InputQueue queue;
  queue.add_key(key(SDLK_LCTRL, SDL_SCANCODE_LCTRL, true, KMOD_LCTRL));
  queue.add_key(key(SDLK_a, SDL_SCANCODE_A, true, KMOD_LCTRL));
  queue.add_key(key(SDLK_LCTRL, SDL_SCANCODE_LCTRL, false));  // released before the letter
  queue.add_key(key(SDLK_a, SDL_SCANCODE_A, false));
  InputQueue::Frame frame = queue.next();
  EXPECT_TRUE(frame.keys[SDL_SCANCODE_A]);
  EXPECT_NE(frame.modifiers & KMOD_CTRL, 0);
  frame = queue.next();
  EXPECT_TRUE(frame.keys.none());
  EXPECT_EQ(frame.modifiers, 0);
}

TEST(InputQueue, TextIsTypedAfterTheCommandBeforeIt) {
  InputQueue queue;
  queue.add_text("1");
  tap(queue, SDLK_BACKSPACE, SDL_SCANCODE_BACKSPACE);
  queue.add_text("6");
  queue.add_text("0");
  EXPECT_EQ(queue.next().text, "1");
  EXPECT_EQ(queue.next().text, "60");
  EXPECT_EQ(queue.next().text, "");
}

TEST(InputQueue, FastTypingIsNotSpreadOverFrames) {
  InputQueue queue;
  for (const char* letter : {"7", "7", "5"}) {
    const SDL_Scancode code = letter[0] == '7' ? SDL_SCANCODE_7 : SDL_SCANCODE_5;
    queue.add_key(key(letter[0], code, true));
    queue.add_text(letter);
    queue.add_key(key(letter[0], code, false));
  }
  EXPECT_EQ(queue.next().text, "775");
}

TEST(InputQueue, RepeatsOfAHeldKeyAreNoPresses) {
  InputQueue queue;
  queue.add_key(key(SDLK_DOWN, SDL_SCANCODE_DOWN, true));
  SDL_KeyboardEvent repeat = key(SDLK_DOWN, SDL_SCANCODE_DOWN, true);
  repeat.repeat = 1;
  queue.add_key(repeat);
  queue.add_key(key(SDLK_DOWN, SDL_SCANCODE_DOWN, false));
  EXPECT_TRUE(queue.next().keys[SDL_SCANCODE_DOWN]);
  EXPECT_TRUE(queue.next().keys.none());
}

TEST(EscapeGuard, AnEscAfterOneThatClosedADialogDoesNotLeave) {
  EscapeGuard guard;
  EXPECT_TRUE(guard.leaves(1000, false)) << "nothing was closed";
  EXPECT_FALSE(guard.leaves(2000, true));
  EXPECT_FALSE(guard.leaves(2499, false)) << "a second tap for the same dialog";
  EXPECT_TRUE(guard.leaves(2500, false));
}

}  // namespace
}  // namespace palpate::app
