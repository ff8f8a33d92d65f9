#include "view/render/tissue_appearance.h"

namespace palpate::render {

TissueAppearance tissue_appearance(const std::string& tissue_name) {
  TissueAppearance look;
  if (tissue_name == "gallbladder") {  // bile looks grey-green through the pale wall
    look.base = {0.320F, 0.350F, 0.200F};
    look.mottle = {0.185F, 0.265F, 0.215F};
    look.vessel = {0.33F, 0.085F, 0.06F};
    look.fat = {0.62F, 0.47F, 0.20F};
    look.vessel_share = 0.50F;
    look.fat_share = 0.12F;
    look.vessel_per_m = 62.0F;
  } else if (tissue_name == "heart") {
    look.base = {0.26F, 0.034F, 0.026F};
    look.mottle = {0.34F, 0.072F, 0.052F};
    look.vessel = {0.11F, 0.010F, 0.014F};
    look.fat = {0.56F, 0.34F, 0.12F};
    look.vessel_share = 0.6F;
    look.fat_share = 0.32F;
    look.mottle_per_m = 110.0F;
    look.vessel_per_m = 42.0F;
  } else if (tissue_name == "liver") {
    look.base = {0.100F, 0.0225F, 0.0138F};
    look.mottle = {0.134F, 0.037F, 0.022F};
    look.vessel = {0.085F, 0.016F, 0.012F};
    look.fat = {0.45F, 0.25F, 0.11F};
    look.vessel_share = 0.12F;
  } else if (tissue_name == "kidney") {
    look.base = {0.140F, 0.027F, 0.019F};
    look.mottle = {0.178F, 0.047F, 0.032F};
    look.vessel = {0.13F, 0.016F, 0.013F};
    look.fat = {0.6F, 0.42F, 0.19F};
    look.vessel_share = 0.2F;
    look.fat_share = 0.08F;
  } else {
    look.base = {0.50F, 0.185F, 0.145F};
    look.mottle = {0.58F, 0.27F, 0.21F};
    look.vessel = {0.32F, 0.05F, 0.045F};
    look.fat = {0.66F, 0.46F, 0.22F};
    look.vessel_share = 0.35F;
  }
  return look;
}

}  // namespace palpate::render
