// Mouse, keyboard and dropped files of a viewer.
#include <utility>

#include <imgui.h>

#include "app/window/viewer.h"

namespace palpate::app {

void Viewer::take_event(const SDL_Event& event, std::pair<int, int> way) {
  switch (event.type) {
    case SDL_KEYDOWN:
      key_down(event.key);
      break;
    case SDL_MOUSEMOTION:
      (void)camera_controller_.mouse_moved(way, layout_.picture.height);
      break;
    case SDL_MOUSEBUTTONDOWN:
    case SDL_MOUSEBUTTONUP:
      mouse_button(event.button);
      break;
    case SDL_MOUSEWHEEL:
      if (Viewport::over(layout_.picture, viewport_.mouse_at().first, viewport_.mouse_at().second))
        camera_controller_.wheel_turned(event.wheel.y);
      break;
    case SDL_DROPFILE: {
      const std::filesystem::path file = event.drop.file;
      if (use_of_file(file) == FileUse::kRecording) {
        commands_.open = file.string();
      } else {
        viewport_.show_message(file.filename().string() +
                               ": a recording (.h5) can be looked at here; palpate run takes other files");
      }
      break;
    }
    default:
      break;
  }
}

void Viewer::mouse_button(const SDL_MouseButtonEvent& button) {
  const bool down = button.type == SDL_MOUSEBUTTONDOWN;
  if (down && !Viewport::over(layout_.picture, button.x, button.y)) return;
  if (down) ImGui::SetWindowFocus(nullptr);  // returns the keyboard to the picture
  camera_controller_.button(button, true);
}

void Viewer::key_down(const SDL_KeyboardEvent& key) {
  const SDL_Keycode which = key.keysym.sym;
  panel_key(which);
  if (state_.files.is_open() || ImGui::GetIO().WantTextInput) return;
  if (which == SDLK_ESCAPE) {
    const bool in_panels = state_.help || ImGui::GetIO().NavVisible;
    state_.help = false;
    ImGui::SetWindowFocus(nullptr);
    if (!in_panels) leaving_ = true;
    return;
  }
  const bool control = (key.keysym.mod & KMOD_CTRL) != 0;
  if (control && which == SDLK_o) {
    state_.files.open(FileUse::kRecording, std::filesystem::absolute(view().file()).parent_path());
  }
  if (control && which == SDLK_p) commands_.save_picture = true;
  if (!control) letter_key(which);
  if (ImGui::GetIO().NavVisible) return;  // the panels use arrows and Space
  if ((key.keysym.mod & KMOD_ALT) != 0) {
    camera_controller_.arrow_key(key);
  } else {
    time_key(key);
  }
}

void Viewer::panel_key(SDL_Keycode which) {
  if (which >= SDLK_F2 && which <= SDLK_F4) {
    bool& open = state_.open[static_cast<std::size_t>(which - SDLK_F2)];
    open = state_.hidden || !open;
    state_.hidden = false;
  }
  if (which == SDLK_F7) {
    state_.plots = state_.hidden || !state_.plots;
    state_.hidden = false;
  }
  if (which == SDLK_F1) state_.help = !state_.help;
  if (which == SDLK_F8) state_.hidden = !state_.hidden;
  if (which == SDLK_F11) commands_.full_screen = true;
}

void Viewer::time_key(const SDL_KeyboardEvent& key) {
  const SDL_Keycode which = key.keysym.sym;
  const int on = sign_of(which, SDLK_RIGHT, SDLK_LEFT);
  if ((key.keysym.mod & KMOD_CTRL) != 0) {
    commands_.seconds += on;
  } else if ((key.keysym.mod & KMOD_SHIFT) != 0) {
    commands_.ticks += on;
  } else {
    commands_.pictures += on;
  }
  const int faster = sign_of(which, SDLK_UP, SDLK_DOWN);
  if (faster != 0) playback_->change_speed(faster);
  if (which == SDLK_SPACE) commands_.play = true;
  if (which == SDLK_HOME) commands_.go_to = 0;
  if (which == SDLK_END) commands_.go_to = playback_->last();
}

void Viewer::letter_key(SDL_Keycode which) {
  const HandOverview& hand = overview().hands[state_.hand];
  if (which == SDLK_c && !hand.contacts.empty()) commands_.go_to = hand.contacts.front().first;
  if (which == SDLK_c && hand.contacts.empty()) viewport_.show_message("this hand never touches the tissue");
  if (which == SDLK_d) commands_.go_to = hand.deepest;
  if (which == SDLK_f && !hand.faults.empty()) commands_.go_to = next_fault(hand, shown_.tick);
  if (which == SDLK_f && hand.faults.empty()) viewport_.show_message("no fault was latched on this hand");
  if (which == SDLK_m) state_.map = !state_.map;
  if (which == SDLK_p) commands_.save_window = true;
  if (which == SDLK_s) state_.drape = !state_.drape;
  if (which == SDLK_v) commands_.home = true;
  if (which == SDLK_z) {
    state_.close_up = !state_.close_up;
    commands_.home = true;
  }
  camera_controller_.zoom_key(which);
  if (which >= SDLK_0 && which <= SDLK_3) commands_.hand = static_cast<std::uint32_t>(which - SDLK_0);
}

void Viewer::grant(const ViewerCommands& commands) {
  if (commands.leave) leaving_ = true;
  if (commands.go_to) playback_->go_to(*commands.go_to);
  if (commands.ticks != 0) playback_->step_ticks(commands.ticks);
  if (commands.pictures != 0) playback_->step_pictures(commands.pictures);
  if (commands.seconds != 0.0) playback_->skip(commands.seconds);
  if (commands.speed) playback_->choose_speed(*commands.speed);
  if (commands.play) playback_->toggle();
  if (commands.hand && *commands.hand < view().hands()) state_.hand = *commands.hand;
  if (commands.home) camera_.look_exactly_as(first_camera());
  if (commands.full_screen) viewport_.display().toggle_full_screen();
  if (commands.save_picture) {
    if (there_) {
      viewport_.save(still_picture());
    } else {
      commands_.save_picture = true;  // saved when the requested tick is shown
    }
  }
  if (commands.open) begin_to_open(*commands.open);
}

}  // namespace palpate::app
