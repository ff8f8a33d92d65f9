// Runs a whole session of a prepared study in its windows on a virtual display, with a simulated observer in
// the chair: palpate_study_session FOLDER PICTURES [WIDTH HEIGHT]. Keeps a picture of each different screen.
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <string>

#include "app/window/test/virtual_display.h"
#include "study/screens/test/study_chair.h"
#include "study/session/run_session.h"

int main(int argc, char** argv) {
  namespace study = palpate::study;
  try {
    if (argc != 3 && argc != 5)
      throw std::runtime_error("usage: palpate_study_session FOLDER PICTURES [WIDTH HEIGHT]");
    const palpate::app::VirtualDisplay display;
    if (!display.there()) throw std::runtime_error("there is no Xvfb (Debian package xvfb)");
    std::filesystem::create_directories(argv[2]);
    study::StudyFolder folder = study::open_study(argv[1]);
    study::mark_simulated(folder);
    palpate::app::StudyScreensOptions windows;
    windows.title = folder.study.name + ": " + folder.ids.front();
    windows.sound = false;
    windows.size = {1280, 800};
    if (argc == 5) windows.size = {std::stoi(argv[3]), std::stoi(argv[4])};
    palpate::app::StudyScreens screens(folder.study, windows);
    palpate::app::StudyChair chair(screens, argv[2]);
    study::SessionOptions options;
    options.participant = folder.ids.front();
    options.observer = "ideal";
    options.screens = &chair;
    const study::SessionOutcome outcome = study::run_session(folder, folder.key, options);
    std::cout << options.participant << ": " << outcome.trials << " trials in " << outcome.blocks
              << " blocks, " << outcome.spoiled << " spoiled, " << chair.questions << " questions; "
              << (outcome.complete ? "complete" : "not complete") << '\n';
    return outcome.complete ? 0 : 4;
  } catch (const std::exception& error) {
    std::cerr << "palpate_study_session: " << error.what() << '\n';
    return 2;
  }
}
