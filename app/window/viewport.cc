#include "app/window/viewport.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <backends/imgui_impl_opengl3.h>
#include <backends/imgui_impl_sdl.h>
#include <epoxy/gl.h>
#include <fmt/core.h>
#include <imgui.h>

#include "io/system/clock.h"
#include "palpate/error.h"
#include "view/render/gl_objects.h"

#include "app/numbers.h"
#include "app/run_tape.h"
#include "app/window/run_in_window.h"

namespace palpate::app {
namespace {

/// ImGui's index of a mouse button, or -1.
int imgui_button(Uint8 button) {
  if (button == SDL_BUTTON_LEFT) return 0;
  if (button == SDL_BUTTON_RIGHT) return 1;
  return button == SDL_BUTTON_MIDDLE ? 2 : -1;
}

float strip_height(float width, const std::string& text) {
  const float margin = 0.7F * ImGui::GetFontSize();
  return ImGui::CalcTextSize(text.c_str(), nullptr, false, width - 2.0F * margin).y + margin;
}

float draw_strip(float x, float y, float width, const std::string& text, bool fault) {
  const float margin = 0.7F * ImGui::GetFontSize();
  const float height = strip_height(width, text);
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  list.AddRectFilled(ImVec2(x, y), ImVec2(x + width, y + height),
                     packed(fault ? colour::kFault : colour::kNotice, 0.94F));
  list.AddText(nullptr, 0.0F, ImVec2(x + margin, y + 0.5F * margin), packed(colour::kText), text.c_str(),
               nullptr, width - 2.0F * margin);
  return height;
}

void draw_title(const Rectangle& picture, float y, const std::string& title) {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const float margin = 0.7F * ImGui::GetFontSize();
  list.AddText(ImVec2(picture.x + margin, y + 0.5F * margin), packed(colour::kText, 0.9F), title.c_str());
  const char* help = "F1: keys";
  const float wide = ImGui::CalcTextSize(help).x;
  if (picture.width <= ImGui::CalcTextSize(title.c_str()).x + wide + 4.0F * margin) return;
  list.AddText(ImVec2(picture.x + picture.width - wide - margin, y + 0.5F * margin),
               packed(colour::kText, 0.7F), help);
}

}  // namespace

std::optional<float> UiScale::asked(const std::string& flag) {
  std::string name = "--ui-scale";
  std::string text = flag;
  if (text.empty()) {
    const char* variable =
        std::getenv("PALPATE_UI_SCALE");  // NOLINT(concurrency-mt-unsafe): nothing writes it
    if (variable == nullptr || *variable == '\0') return std::nullopt;
    name = "PALPATE_UI_SCALE";
    text = variable;
  }
  const double scale = parse_positive(name, text);
  if (!(scale >= kLeast && scale <= kMax))
    throw InputError(fmt::format("{} {}: want a number from 0.5 to 4; 1 is 96 dots an inch", name, text));
  return static_cast<float>(scale);
}

Viewport::Viewport(const std::string& title, Display::Size size, std::optional<float> scale,
                   std::vector<ExtraFont> fonts)
    : display_(title, size), fonts_(std::move(fonts)), asked_(scale) {
  IMGUI_CHECKVERSION();
  context_ = ImGui::CreateContext();
  ImGui::SetCurrentContext(context_);
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;  // do not write imgui.ini
  ImGui_ImplSDL2_InitForOpenGL(display_.window(), display_.context());
  ImGui_ImplOpenGL3_Init("#version 330 core");
  scale_ = asked_.value_or(display_.scale());
  pixels_a_unit_ = enlarged();
  set_theme(scale_, static_cast<float>(pixels_a_unit_), fonts_);
}

Viewport::~Viewport() {
  if (display_.lost()) return;  // no call may use the lost display
  activate();
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplSDL2_Shutdown();
  ImGui::DestroyContext(context_);
}

void Viewport::activate() const {
  SDL_GL_MakeCurrent(display_.window(), display_.context());
  ImGui::SetCurrentContext(context_);
}

void Viewport::set_scale(float scale) {
  asked_ = scale;
  scale_may_differ_ = true;
}

double Viewport::enlarged() const {
  const Display::Size units = display_.size();
  return units.width > 0 ? std::max(1.0, static_cast<double>(display_.pixels().width) / units.width) : 1.0;
}

bool Viewport::take_events(
    const std::atomic<bool>* stop,
    const std::function<void(const SDL_Event& event, std::pair<int, int> way)>& taker) {
  bool closes = stop != nullptr && stop->load(std::memory_order_relaxed);
  SDL_Event event;
  while (SDL_PollEvent(&event) != 0) {
    std::pair<int, int> way;
    if (event.type == SDL_MOUSEMOTION)
      way = {event.motion.x - mouse_at_.first, event.motion.y - mouse_at_.second};
    take(event);
    taker(event, way);
    if (event.type == SDL_DROPFILE) SDL_free(event.drop.file);
    closes = closes || event.type == SDL_QUIT ||
             (event.type == SDL_WINDOWEVENT && event.window.event == SDL_WINDOWEVENT_CLOSE);
  }
  return closes;
}

void Viewport::take(const SDL_Event& event) {
  if (event.type == SDL_KEYDOWN || event.type == SDL_KEYUP) {
    input_.add_key(event.key);
  } else if (event.type == SDL_TEXTINPUT) {
    input_.add_text(event.text.text);
  } else {
    ImGui_ImplSDL2_ProcessEvent(&event);
  }
  if (event.type == SDL_MOUSEMOTION) mouse_at_ = {event.motion.x, event.motion.y};
  if (event.type == SDL_MOUSEBUTTONDOWN || event.type == SDL_MOUSEBUTTONUP) take_mouse(event.button);
  if (event.type == SDL_KEYDOWN) take_key(event.key.keysym);
  if (event.type == SDL_MOUSEBUTTONDOWN) keys_in_panels_ = false;
  if (event.type != SDL_WINDOWEVENT) return;
  // The window may have moved to a display with another resolution, or the system's scale has changed.
  if (event.window.event == SDL_WINDOWEVENT_DISPLAY_CHANGED ||
      event.window.event == SDL_WINDOWEVENT_SIZE_CHANGED)
    scale_may_differ_ = true;
}

/// Keys belong to the picture, even after a click on a panel. Ctrl + Tab gives them to the panels; Esc or a
/// mouse button returns them.
void Viewport::take_key(const SDL_Keysym& key) {
  if (key.sym == SDLK_TAB && (key.mod & KMOD_CTRL) != 0) keys_in_panels_ = true;
  if (key.sym == SDLK_ESCAPE) keys_in_panels_ = false;
}

void Viewport::take_mouse(const SDL_MouseButtonEvent& button) {
  mouse_at_ = {button.x, button.y};
  const int number = imgui_button(button.button);
  if (number < 0) return;
  input_.add_button(static_cast<std::size_t>(number), button.type == SDL_MOUSEBUTTONDOWN);
}

/// Gives the panels the keys, buttons and text of this frame.
void Viewport::pass_input() {
  constexpr float kDoubleClick = 0.3F;  // s, at a high frame rate
  const InputQueue::Frame frame = input_.next();
  ImGuiIO& io = ImGui::GetIO();
  for (std::size_t code = 0; code < frame.keys.size(); ++code) io.KeysDown[code] = frame.keys[code];
  io.KeyCtrl = (frame.modifiers & KMOD_CTRL) != 0;
  io.KeyShift = (frame.modifiers & KMOD_SHIFT) != 0;
  io.KeyAlt = (frame.modifiers & KMOD_ALT) != 0;
  io.KeySuper = (frame.modifiers & KMOD_GUI) != 0;
  if (!frame.text.empty()) io.AddInputCharactersUTF8(frame.text.c_str());
  for (std::size_t button = 0; button < frame.buttons.size(); ++button) {
    io.MouseDown[button] = frame.buttons[button];
  }
  io.MouseDoubleClickTime = kDoubleClick + 2.0F * io.DeltaTime;  // its clicks are in frames of their own
}

void Viewport::look_at_scale() {
  if (!scale_may_differ_) return;
  scale_may_differ_ = false;
  const float scale = asked_.value_or(display_.scale());
  const double pixels_a_unit = enlarged();
  if (scale == scale_ && std::abs(pixels_a_unit - pixels_a_unit_) < 0.01) return;
  scale_ = scale;
  pixels_a_unit_ = pixels_a_unit;
  set_theme(scale_, static_cast<float>(pixels_a_unit_), fonts_);
  ImGui_ImplOpenGL3_DestroyFontsTexture();
  ImGui_ImplOpenGL3_CreateFontsTexture();
}

bool Viewport::over(const Rectangle& place, int x, int y) {
  const auto fx = static_cast<float>(x);
  const auto fy = static_cast<float>(y);
  return fx >= place.x && fx < place.x + place.width && fy >= place.y && fy < place.y + place.height &&
         !ImGui::GetIO().WantCaptureMouse;
}

void Viewport::begin_panels() {
  look_at_scale();
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplSDL2_NewFrame();
  // Use the mouse position of the events. It differs from the system's when a test sends events.
  ImGuiIO& io = ImGui::GetIO();
  io.MousePos = ImVec2(static_cast<float>(mouse_at_.first), static_cast<float>(mouse_at_.second));
  pass_input();
  const bool dialog = ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopup);
  if (keys_in_panels_ || dialog) {
    io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
  } else {
    io.ConfigFlags &= ~ImGuiConfigFlags_NavEnableKeyboard;
  }
  ImGui::NewFrame();
}

void Viewport::end_panels() { ImGui::Render(); }

void Viewport::clear() {
  const Display::Size size = display_.pixels();
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, size.width, size.height);
  glClearColor(colour::kBackground.x, colour::kBackground.y, colour::kBackground.z, 1.0F);
  glClear(GL_COLOR_BUFFER_BIT);
}

void Viewport::draw_panels() { ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData()); }

render::Image Viewport::picture() const {
  const Display::Size size = display_.pixels();
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  return render::read_pixels(size.width, size.height);
}

bool Viewport::graphics_lost() const {
  const bool can_say = epoxy_gl_version() >= 45 || epoxy_has_gl_extension("GL_ARB_robustness");
  if (!can_say) return false;
  const GLenum status = epoxy_gl_version() >= 45 ? glGetGraphicsResetStatus() : glGetGraphicsResetStatusARB();
  return status != GL_NO_ERROR;
}

bool Viewport::out_of_memory() {
  bool ran_out = false;
  for (int i = 0; i < 16; ++i) {  // bounded, because a lost context may report errors forever
    const GLenum error = glGetError();
    if (error == GL_NO_ERROR) break;
    ran_out = ran_out || error == GL_OUT_OF_MEMORY;
  }
  return ran_out;
}

void Viewport::show_message(std::string message) {
  constexpr std::int64_t kShown_ns = 8'000'000'000;
  message_ = std::move(message);
  message_until_ns_ = monotonic_ns() + kShown_ns;
}

void Viewport::save(const render::Image& image) {
  const std::filesystem::path file = named_by_time(".png");
  try {
    render::write_png(image, file);
    show_message("the picture is in " + file.string());
  } catch (const InputError& error) {
    show_message(error.what());
  }
}

float Viewport::draw_overlay(const Rectangle& picture, const std::vector<Banner>& banners,
                             const std::string& title) {
  const float text = ImGui::GetFontSize();
  float y = picture.y;
  if (monotonic_ns() > message_until_ns_) message_.clear();
  if (picture.width < 12.0F * text || picture.height < 5.0F * text) return y;
  for (const Banner& banner : banners) {
    if (!banner.text.empty()) y += draw_strip(picture.x, y, picture.width, banner.text, banner.fault);
  }
  draw_title(picture, y, title);
  if (message_.empty()) return y;
  const float top = picture.y + picture.height - strip_height(picture.width, message_);
  draw_strip(picture.x, top, picture.width, message_, false);
  return y;
}

}  // namespace palpate::app
