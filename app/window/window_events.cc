// Mouse, keyboard, gamepads and dropped files of the window.
#include <utility>

#include <imgui.h>

#include "app/window/window.h"

namespace palpate::app {

void Window::take_event(const SDL_Event& event, std::pair<int, int> way) {
  switch (event.type) {
    case SDL_WINDOWEVENT:
      if (event.window.event == SDL_WINDOWEVENT_LEAVE) mouse_inside_ = false;
      break;
    case SDL_KEYDOWN:
      key_down(event.key);
      break;
    case SDL_MOUSEMOTION:
      mouse_motion(way);
      break;
    case SDL_MOUSEBUTTONDOWN:
    case SDL_MOUSEBUTTONUP:
      mouse_button(event.button);
      break;
    case SDL_MOUSEWHEEL:
      mouse_wheel(event.wheel);
      break;
    case SDL_DROPFILE:
      file_dropped(event.drop.file);
      break;
    case SDL_CONTROLLERDEVICEADDED:
    case SDL_CONTROLLERDEVICEREMOVED:
      steering_.gamepad_event(event);
      break;
    default:
      break;
  }
}

void Window::mouse_button(const SDL_MouseButtonEvent& button) {
  const bool down = button.type == SDL_MOUSEBUTTONDOWN;
  if (down) panel_used_ = !over_picture(button.x, button.y);
  if (down && panel_used_) return;
  if (down) ImGui::SetWindowFocus(nullptr);  // returns the keyboard to the picture
  if (button.button == SDL_BUTTON_LEFT && support_ != nullptr && support_->choosing()) {
    if (down) attach_at_pointer();
    return;
  }
  if (button.button == SDL_BUTTON_LEFT) steering_.grip(down);
  camera_controller_.button(button, !steering_.mouse_steers());
}

void Window::mouse_motion(std::pair<int, int> way) {
  mouse_inside_ = true;
  (void)camera_controller_.mouse_moved(way, layout_.picture.height);
}

/// The line of sight through the pointer; nothing: it is not over the picture, or turns the view.
std::optional<geometry::Ray> Window::pointer_ray() const {
  const auto [x, y] = viewport_.mouse_at();
  const Rectangle& place = layout_.picture;
  if (!mouse_inside_ || !over_picture(x, y) || camera_controller_.busy() || !camera_set_) return std::nullopt;
  const auto share = [](int at, float from, float length) {
    return static_cast<double>((static_cast<float>(at) + 0.5F - from) / length);
  };
  return ray_through(camera_.camera(), aspect(), share(x, place.x, place.width),
                     share(y, place.y, place.height));
}

/// The tool rides under the pointer. On a panel, while the pointer turns the view and while it chooses what
/// holds the organ, the tool stays.
void Window::point_the_tool() {
  const std::optional<geometry::Ray> ray = pointer_ray();
  if (ray && !(support_ != nullptr && support_->choosing())) {
    steering_.point_at(*ray);
  } else {
    steering_.freeze();
  }
}

void Window::attach_at_pointer() {
  const std::optional<geometry::Ray> ray = pointer_ray();
  if (!ray) return;
  if (support_->pick(*ray, shown_.organ_W, live_)) {
    keep_support();
  } else {
    viewport_.show_message("no organ under the pointer; H ends choosing what holds it");
  }
}

std::optional<std::pair<float, float>> Window::in_window(const Vec3& point_W) const {
  const Rectangle& picture = layout_.picture;
  const std::optional<PicturePlace> place = place_of(point_W, camera_.camera(), aspect());
  if (!place) return std::nullopt;
  return std::pair(picture.x + static_cast<float>(place->x) * picture.width,
                   picture.y + static_cast<float>(place->y) * picture.height);
}

void Window::mouse_wheel(const SDL_MouseWheelEvent& wheel) {
  if (!over_picture(viewport_.mouse_at().first, viewport_.mouse_at().second)) return;
  const bool control = (SDL_GetModState() & KMOD_CTRL) != 0;
  if (steering_.mouse_steers() && !control) {
    steering_.wheel_turned(wheel.y, (SDL_GetModState() & KMOD_SHIFT) != 0);
  } else {
    camera_controller_.wheel_turned(wheel.y);
  }
}

void Window::key_down(const SDL_KeyboardEvent& key) {
  const SDL_Keycode which = key.keysym.sym;
  if (which >= SDLK_F2 && which <= SDLK_F7) {
    bool& open = panels_.open[static_cast<std::size_t>(which - SDLK_F2)];
    open = panels_.hidden || !open;
    panels_.hidden = false;
    return;
  }
  if (which == SDLK_F1) panels_.help = !panels_.help;
  if (which == SDLK_F8) panels_.hidden = !panels_.hidden;
  if (which == SDLK_F11) commands_.full_screen = true;
  if (which == SDLK_ESCAPE) {
    escape_key(key);
    return;
  }
  if (panels_.dialog_is_open() || ImGui::GetIO().WantTextInput) return;
  if ((key.keysym.mod & KMOD_CTRL) != 0) {
    control_key(key.keysym);
  } else if (!ImGui::GetIO().NavVisible) {  // otherwise the panels use arrows, Space and Enter
    view_key(key);
    letter_key(which);
  } else {
    letter_key(which);
  }
}

/// Closes what is open; else leaves, after a question while a recording is written or a search goes on.
/// Dialogs and fields close by themselves in the next frame.
void Window::escape_key(const SDL_KeyboardEvent& key) {
  const bool in_field = panels_.dialog_is_open() || ImGui::GetIO().WantTextInput;
  const bool closes = in_field || panels_.help || ImGui::GetIO().NavVisible;
  const bool leaves = escape_.leaves(key.timestamp, closes);
  if (in_field) return;
  panels_.help = false;
  ImGui::SetWindowFocus(nullptr);
  if (!leaves) return;
  if (recording() || searching()) {
    panels_.leave = LeaveDialog::kOpening;
  } else {
    leaving_ = true;
  }
}

/// Enter runs again, unless a panel was used later than the picture: then the key may be meant for a field.
void Window::enter_key() {
  if (panel_used_) {
    viewport_.show_message("Enter runs again after a click on the picture; or use the button Run again");
  } else if (searching() && !recording()) {
    viewport_.show_message("the search has not ended and is not recorded: end it first, or use Run again");
  } else {
    commands_.again = true;
  }
}

void Window::control_key(const SDL_Keysym& pressed) {
  const SDL_Keycode key = pressed.sym;
  if (key == SDLK_z) commands_.undo = (pressed.mod & KMOD_SHIFT) == 0;
  if (key == SDLK_y) commands_.undo = false;
  if (key == SDLK_r) commands_.record = !recording();
  if (key == SDLK_SPACE) commands_.pause_run = true;
  if (key == SDLK_o) panels_.files.open(FileUse::kOrgan, std::filesystem::current_path());
  if (key == SDLK_s) {
    panels_.files.open(FileUse::kSaveTissue, std::filesystem::current_path() / (now_.tissue.name + ".toml"));
  }
}

void Window::letter_key(SDL_Keycode key) {
  if (key == SDLK_r) commands_.reset_faults = true;
  if (key == SDLK_p) commands_.screenshot = true;
  if (key == SDLK_v) commands_.look = true;
  if (key == SDLK_g) steering_.toggle_rest_of_jaws();
  if (key == SDLK_a) panels_.marks.force = !panels_.marks.force;
  if (key == SDLK_b) panels_.marks.scale = !panels_.marks.scale;
  if (key == SDLK_x) panels_.marks.axes = !panels_.marks.axes;
  if (key == SDLK_c) panels_.marks.section = !panels_.marks.section;
  if (key == SDLK_i) panels_.marks.inside = !panels_.marks.inside;
  if (key == SDLK_d) panels_.drape = !panels_.drape;
  if (key == SDLK_f) steering_.toggle_parked();
  if (key == SDLK_m && search_ != nullptr) {
    steering_.press_button(run_->session().scene().search.mark_button);
  }
  if (key == SDLK_h && support_ != nullptr)
    commands_.support = SupportChange{.choosing = !support_->choosing()};
  if (key == SDLK_t && search_ != nullptr) commands_.map = !search_->shows_map;
  if (key == SDLK_n) {
    commands_.noise = now_.noise;
    commands_.noise->enabled = !now_.noise.enabled;
  }
  if (key >= SDLK_1 && key <= SDLK_4) steering_.choose_hand(static_cast<std::size_t>(key - SDLK_1));
}

void Window::view_key(const SDL_KeyboardEvent& key) {
  const SDL_Keycode which = key.keysym.sym;
  camera_controller_.arrow_key(key);
  camera_controller_.zoom_key(which);
  if (which == SDLK_HOME) commands_.home = true;
  if (which == SDLK_SPACE) commands_.pause = true;
  if (which == SDLK_RETURN || which == SDLK_KP_ENTER) enter_key();
}

void Window::file_dropped(const std::filesystem::path& file) {
  const std::optional<FileUse> use = use_of_file(file);
  if (use == FileUse::kRecording) {
    look_at(file);
  } else if (!use) {
    viewport_.show_message(
        file.filename().string() +
        ": palpate reads meshes, scenes and tissues (.toml), tool paths (.csv) and recordings (.h5)");
  } else if (*use == FileUse::kOrgan) {
    panels_.files.open(*use, file);  // the dialog asks for its unit
  } else {
    commands_.file = ChosenFile{*use, file, ""};
  }
}

}  // namespace palpate::app
