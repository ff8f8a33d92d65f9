// Each reason of `palpate devices`, on a folder that replaces the root folder. The reason appears, and
// disappears after the remedy.
#include "run/devices/reasons.h"

#include <fstream>
#include <map>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/system/test/temporary_folder.h"

namespace palpate::devices {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;

auto reason(const std::string& what, const std::string& command) {
  return AllOf(Field(&Reason::what, HasSubstr(what)), Field(&Reason::command, HasSubstr(command)));
}

class Reasons : public testing::Test {
 protected:
  Reasons() {
    machine_.root = folder_.path();
    machine_.variable = [this](const char* name) { return variables_[name]; };
    machine_.may_open = [this](const fs::path& file) { return fs::exists(file) && closed_.count(file) == 0; };
  }
  void put(const std::string& name, const std::string& text = "") {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }
  void link(const std::string& name, const std::string& target) {
    fs::create_directories((folder_ / name).parent_path());
    fs::create_symlink(target, folder_ / name);
  }
  void plug_in(const std::string& vendor, const std::string& product) {
    put("sys/bus/usb/devices/1-2/idVendor", vendor + "\n");
    put("sys/bus/usb/devices/1-2/idProduct", product + "\n");
    put("sys/bus/usb/devices/1-2/busnum", "1\n");
    put("sys/bus/usb/devices/1-2/devnum", "4\n");
    put("dev/bus/usb/001/004");
  }
  void close(const std::string& node) { closed_.insert(folder_ / node); }
  void open(const std::string& node) { closed_.erase(folder_ / node); }
  void hold(const std::string& node, const std::string& program) {
    put("proc/4242/comm", program + "\n");
    link("proc/4242/fd/5", node);
  }
  void release() { fs::remove(folder_ / "proc/4242/fd/5"); }
  void remove(const std::string& name) { fs::remove_all(folder_ / name); }
  /// Connects a Touch by USB, with its port and the set-up of this user.
  void set_up_touch() {
    plug_in("2988", "0302");
    put("sys/bus/usb/devices/1-2/1-2:1.0/tty/ttyACM0/dev");
    put("dev/ttyACM0");
    variables_["GTDD_HOME"] = "/usr/share/3DSystems";
    put("usr/share/3DSystems/config/Default Device.config");
  }
  void listen(const std::string& port) {
    put("proc/net/tcp",
        "  sl  local_address rem_address   st\n   0: 0100007F:" + port + " 00000000:0000 0A 0\n");
  }

  palpate::test::TemporaryFolder folder_;
  Machine machine_;
  std::map<std::string, std::string> variables_;
  std::set<fs::path> closed_;
};

TEST_F(Reasons, AForceDimensionDeviceThatIsOnUsbAndOpenHasNone) {
  plug_in("1451", "0402");
  EXPECT_THAT(forcedimension_reasons(machine_, true), IsEmpty());
}

TEST_F(Reasons, TheLibraryIsNotInstalledOrNotKnownToTheLoader) {
  plug_in("1451", "0402");
  EXPECT_THAT(forcedimension_reasons(machine_, false),
              ElementsAre(reason("Force Dimension's SDK is not installed", "sudo cp libdhd.so.3")));
  put("usr/local/lib/libdhd.so.3");
  EXPECT_THAT(forcedimension_reasons(machine_, false),
              ElementsAre(reason("/usr/local/lib/libdhd.so.3 is there", "sudo ldconfig")));
}

TEST_F(Reasons, NothingIsOnUsb) {
  plug_in("046d", "c077");
  EXPECT_THAT(forcedimension_reasons(machine_, true), ElementsAre(reason("is on USB", "lsusb -d 1451:")));
  plug_in("0403", "6001");  // another device with FTDI's USB converter
  EXPECT_THAT(forcedimension_reasons(machine_, true), ElementsAre(reason("is on USB", "lsusb -d 0403:cb48")));
}

TEST_F(Reasons, TheUsbNodeIsNotOpenToThisUser) {
  plug_in("1451", "0402");
  close("dev/bus/usb/001/004");
  EXPECT_THAT(forcedimension_reasons(machine_, true),
              ElementsAre(reason("/dev/bus/usb/001/004 is not open to this user, and no udev rule",
                                 R"(ATTRS{idVendor}=="1451", MODE="0660", TAG+="uaccess"' | sudo tee)")));
  put("etc/udev/rules.d/60-palpate.rules", "# 1451\nSUBSYSTEM==\"usb\", ATTR{idVendor}==\"1451\"\n");
  EXPECT_THAT(forcedimension_reasons(machine_, true),
              ElementsAre(reason("although a udev rule names", "udevadm control --reload")));
  open("dev/bus/usb/001/004");
  EXPECT_THAT(forcedimension_reasons(machine_, true), IsEmpty());
}

TEST_F(Reasons, ARuleInACommentOrForAnotherProductIsNone) {
  plug_in("0403", "cb48");
  close("dev/bus/usb/001/004");
  put("etc/udev/rules.d/60-a.rules", "\n# ATTR{idVendor}==\"0403\", ATTR{idProduct}==\"cb48\"\n");
  put("etc/udev/rules.d/60-b.rules", "ATTR{idVendor}==\"0403\", ATTR{idProduct}==\"6001\"\n");
  EXPECT_THAT(forcedimension_reasons(machine_, true),
              ElementsAre(reason("no udev rule", R"("0403", ATTRS{idProduct}=="cb48")")));
}

TEST_F(Reasons, AnotherProgramHasTheDevice) {
  plug_in("1451", "0402");
  hold("/dev/bus/usb/001/004", "HapticDesk");
  EXPECT_THAT(forcedimension_reasons(machine_, true),
              ElementsAre(reason("/dev/bus/usb/001/004 is in use by HapticDesk (process 4242)",
                                 "fuser -v /dev/bus/usb/001/004")));
  release();
  EXPECT_THAT(forcedimension_reasons(machine_, true), IsEmpty());
}

TEST_F(Reasons, TheKernelsSerialDriverHoldsTheFalcon) {
  plug_in("0403", "cb48");
  link("sys/bus/usb/devices/1-2/1-2:1.0/driver", "../../drivers/ftdi_sio");
  EXPECT_THAT(forcedimension_reasons(machine_, true),
              ElementsAre(reason("Falcon", "sudo tee /sys/bus/usb/drivers/ftdi_sio/unbind")));
  remove("sys/bus/usb/devices/1-2/1-2:1.0/driver");
  EXPECT_THAT(forcedimension_reasons(machine_, true), IsEmpty());
}

TEST_F(Reasons, ATouchThatIsSetUpHasNone) {
  set_up_touch();
  EXPECT_THAT(touch_reasons(machine_, true), IsEmpty());
  EXPECT_THAT(touch_reasons(machine_, false), ElementsAre(reason("OpenHaptics", "ldconfig -p")));
  put("usr/lib/libHD.so");
  EXPECT_THAT(touch_reasons(machine_, false), ElementsAre(reason("/usr/lib/libHD.so is there", "ldconfig")));
}

TEST_F(Reasons, TheFolderOfTouchSetupIsNotNamed) {
  set_up_touch();
  variables_["GTDD_HOME"] = "";
  variables_["HOME"] = "/people/ada";
  EXPECT_THAT(touch_reasons(machine_, true),
              ElementsAre(reason("GTDD_HOME is not set", "GTDD_HOME=/usr/share/3DSystems")));
  put("people/ada/.3dsystems/config/Default Device.config");
  EXPECT_THAT(touch_reasons(machine_, true),
              ElementsAre(reason("GTDD_HOME is not set", "GTDD_HOME=/people/ada/.3dsystems")));
  variables_["SUDO_USER"] = "ada";
  EXPECT_THAT(touch_reasons(machine_, true), ElementsAre(reason("under sudo", "sudo -E palpate")));
}

TEST_F(Reasons, TheFolderOfTouchSetupIsMissingOrHasNoArm) {
  set_up_touch();
  variables_["GTDD_HOME"] = "/opt/none";
  EXPECT_THAT(touch_reasons(machine_, true),
              ElementsAre(reason("GTDD_HOME = \"/opt/none\": there is no such folder", "export GTDD_HOME")));
  put("opt/none/config/readme.txt");
  EXPECT_THAT(touch_reasons(machine_, true), ElementsAre(reason("no arm is set up", "Touch_Setup")));
  put("opt/none/config/Left.config");
  EXPECT_THAT(touch_reasons(machine_, true), IsEmpty());
}

TEST_F(Reasons, TheTouchsPortIsMissingClosedOrInUse) {
  set_up_touch();
  close("dev/ttyACM0");
  EXPECT_THAT(touch_reasons(machine_, true),
              ElementsAre(reason("/dev/ttyACM0 is not open", R"(SUBSYSTEM=="usb|tty|hidraw")")));
  open("dev/ttyACM0");
  hold("/dev/ttyACM0", "ModemManager");
  EXPECT_THAT(touch_reasons(machine_, true), ElementsAre(reason("in use by ModemManager", "fuser -v")));
  release();
  remove("sys/bus/usb/devices/1-2/1-2:1.0/tty");
  EXPECT_THAT(touch_reasons(machine_, true), ElementsAre(reason("no /dev/ttyACM*", "modprobe cdc_acm")));
}

TEST_F(Reasons, ATouchHidHasAHidrawAndTheOtherNumbers) {
  set_up_touch();
  plug_in("0301", "2988");
  remove("sys/bus/usb/devices/1-2/1-2:1.0/tty");
  put("sys/bus/usb/devices/1-2/1-2:1.0/0003:0301:2988.0001/hidraw/hidraw3/dev");
  put("dev/hidraw3");
  EXPECT_THAT(touch_reasons(machine_, true), IsEmpty());
  close("dev/hidraw3");
  EXPECT_THAT(touch_reasons(machine_, true), ElementsAre(reason("/dev/hidraw3 is not open", "\"0301\"")));
  plug_in("0301", "1111");
  EXPECT_THAT(touch_reasons(machine_, true), ElementsAre(reason("is on USB", "lsusb -d 2988:")));
}

TEST_F(Reasons, ThereAreNeverMoreThanThree) {
  set_up_touch();
  variables_["GTDD_HOME"] = "";
  close("dev/ttyACM0");
  hold("/dev/ttyACM0", "Touch_Diagnosti");
  EXPECT_THAT(touch_reasons(machine_, false),
              ElementsAre(reason("OpenHaptics", ""), reason("GTDD_HOME", ""), reason("not open", "")));
}

TEST_F(Reasons, HaplysServiceIsNotInstalledDoesNotRunOrIsTooOld) {
  put("dev/ttyACM0");
  EXPECT_THAT(haply_reasons(machine_), ElementsAre(reason("not installed", "apt install ./haply-inverse")));
  put("lib/systemd/system/haply-inverse-service.service");
  EXPECT_THAT(haply_reasons(machine_), ElementsAre(reason("does not run", "systemctl start haply")));
  listen("2710");  // hexadecimal of port 10000
  EXPECT_THAT(haply_reasons(machine_), ElementsAre(reason("port 10000 alone", "apt install")));
  listen("2711");  // hexadecimal of port 10001
  EXPECT_THAT(haply_reasons(machine_), IsEmpty());
}

TEST_F(Reasons, AConnectionToPort10001IsNoListener) {
  put("dev/ttyACM0");
  put("proc/net/tcp", "   0: 0100007F:2711 0100007F:D431 01 0\n   1: 0100007F:D431 00000000:0000 0A 0\n");
  EXPECT_THAT(haply_reasons(machine_), ElementsAre(reason("not installed", "")));
  put("proc/net/tcp6",
      "   0: 00000000000000000000000001000000:2711 00000000000000000000000000000000:0000 0A 0\n");
  EXPECT_THAT(haply_reasons(machine_), IsEmpty());
}

TEST_F(Reasons, TheInverse3HasNoPortOrOneThatIsClosedOrInUse) {
  listen("2711");
  EXPECT_THAT(haply_reasons(machine_), ElementsAre(reason("no serial port", "ls /dev/ttyACM*")));
  put("dev/ttyUSB0");
  EXPECT_THAT(haply_reasons(machine_), IsEmpty());
  close("dev/ttyUSB0");
  EXPECT_THAT(haply_reasons(machine_), ElementsAre(reason("/dev/ttyUSB0 is not open", "dialout")));
  open("dev/ttyUSB0");
  hold("/dev/ttyUSB0", "minicom");
  EXPECT_THAT(haply_reasons(machine_), ElementsAre(reason("in use by minicom", "fuser -v /dev/ttyUSB0")));
  put("proc/4242/comm", "haply-inverse-s\n");
  EXPECT_THAT(haply_reasons(machine_), IsEmpty()) << "the service's own";
}

TEST_F(Reasons, MouseAndGamepadNeedADisplay) {
  put("sys/class/input/js0/device/event5/dev");
  put("dev/input/event5");
  EXPECT_THAT(mouse_reasons(machine_), ElementsAre(reason("no display", "ssh -X")));
  EXPECT_THAT(gamepad_reasons(machine_), ElementsAre(reason("no display", "ssh -X")));
  variables_["WAYLAND_DISPLAY"] = "wayland-0";
  EXPECT_THAT(mouse_reasons(machine_), IsEmpty());
  EXPECT_THAT(gamepad_reasons(machine_), IsEmpty());
}

TEST_F(Reasons, AGamepadIsMissingOrClosed) {
  variables_["DISPLAY"] = ":0";
  EXPECT_THAT(gamepad_reasons(machine_),
              ElementsAre(reason("no gamepad is plugged in", "ls"), reason("not loaded", "modprobe joydev")));
  put("sys/module/joydev/initstate");
  EXPECT_THAT(gamepad_reasons(machine_), ElementsAre(reason("no gamepad is plugged in", "ls")));
  put("sys/class/input/js0/device/event5/dev");
  EXPECT_THAT(gamepad_reasons(machine_), ElementsAre(reason("/dev/input/event5 is missing", "docker run")));
  put("dev/input/event5");
  close("dev/input/event5");
  EXPECT_THAT(gamepad_reasons(machine_),
              ElementsAre(reason("/dev/input/event5 is not open", "usermod -aG input")));
}

TEST_F(Reasons, TheRulesThatPalpateInstallsNameEveryDeviceThatIsLookedFor) {
  set_up_touch();
  put("usr/lib/udev/rules.d/60-palpate.rules");
  fs::copy_file(PALPATE_UDEV_RULES, folder_ / "usr/lib/udev/rules.d/60-palpate.rules",
                fs::copy_options::overwrite_existing);
  close("dev/ttyACM0");
  close("dev/bus/usb/001/004");
  for (const auto& [vendor, product] : {std::pair("1451", "0402"), std::pair("0403", "cb48")}) {
    plug_in(vendor, product);
    EXPECT_THAT(forcedimension_reasons(machine_, true),
                ElementsAre(reason("although a udev rule", "udevadm")));
  }
  for (const auto& [vendor, product] : {std::pair("2988", "0302"), std::pair("0301", "2988")}) {
    plug_in(vendor, product);
    EXPECT_THAT(touch_reasons(machine_, true), ElementsAre(reason("although a udev rule", "udevadm")));
  }
}

TEST_F(Reasons, AnEmptyMachineIsNoError) {
  EXPECT_FALSE(forcedimension_reasons(machine_, true).empty());
  EXPECT_FALSE(touch_reasons(machine_, true).empty());
  EXPECT_FALSE(haply_reasons(machine_).empty());
}

}  // namespace
}  // namespace palpate::devices
