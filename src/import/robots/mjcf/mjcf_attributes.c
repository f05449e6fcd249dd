#include "robots/mjcf/mjcf_sections.h"

#include "xml/nodes.h"

static const char rigid[] = "a rigid limit, friction or constraint without it";
static const char ground_law[] = "ground_stiffness and ground_damping of the robot";
static const char extended_shapes[] = "shapes that are larger by the difference of margin and gap";
static const char smaller_range[] = "a range that is smaller by it";

/* Attributes in the schema of MuJoCo 4. Attributes and elements that are reported elsewhere count as read. */
static const struct Attributes table[] = {
    {"compiler",
     "alignfree angle assetdir autolimits balanceinertia boundinertia boundmass conflict coordinate discardvisual "
     "eulerseq fitaabb fusestatic inertiafromgeom inertiagrouprange meshdir passthrough savecanonical savecompiled "
     "saveinertial settotalmass strippath texturedir usethread convexhull exactmeshinertia",
     NULL, ALWAYS_ACTS},
    {"option",
     "actuatorgroupdisable ccd_iterations ccd_tolerance mpr_iterations mpr_tolerance cone density gravity impratio "
     "integrator iterations jacobian ls_iterations ls_tolerance magnetic noslip_iterations noslip_tolerance "
     "o_friction o_margin o_solimp o_solref sdf_initpoints sdf_iterations sleep_tolerance solver timestep tolerance "
     "viscosity wind apirate collision",
     NULL, ALWAYS_ACTS},
    {"flag",
     "actuation autoreset clampctrl constraint contact damper diagexact energy equality eulerdamp filterparent "
     "frictionloss fwdinv gravity invdiscrete ipc island limit midphase multiccd nativeccd passive refsafe sensor "
     "sensornoise sleep speculative spring warmstart",
     NULL, ALWAYS_ACTS},
    {"flag", "override", "friction of the geoms themselves", ACTS_ON_GROUND},
    {"worldbody body frame",
     "axisangle childclass euler fuse gravcomp mocap name pos quat simple sleep user xyaxes zaxis", NULL, ALWAYS_ACTS},
    {"inertial", "axisangle diaginertia euler fullinertia mass pos quat xyaxes zaxis", NULL, ALWAYS_ACTS},
    {"joint",
     "actuatorfrclimited actuatorfrcrange actuatorgravcomp armature axis class damping frictionloss group limited name "
     "pos range ref springdamper springref stiffness type user active joint joint1 joint2 coef polycoef",
     NULL, ALWAYS_ACTS},
    {"freejoint", "align group name", NULL, ALWAYS_ACTS},
    {"geom",
     "axisangle castshadow class conaffinity condim contype density euler fitscale fluidcoef fluidshape friction "
     "fromto "
     "gap group hfield mass material mesh name pos priority quat rgba shellinertia size type user xyaxes zaxis geom "
     "sidesite",
     NULL, ALWAYS_ACTS},
    {"pair", "class condim friction gap geom1 geom2 name", NULL, ALWAYS_ACTS},
    {"geom pair", "solref solimp solmix solreffriction", ground_law, ACTS_ON_GROUND},
    {"geom pair", "margin", extended_shapes, ACTS_ON_GROUND},
    {"geom pair", "adhesion", "a <force> that holds the shape to the ground", ACTS_ON_GROUND},
    {"geom", "surfacevel", "a <contact> with a shape that moves, in a <system> that includes the robot",
     ACTS_ON_GROUND},
    {"exclude", "body1 body2 name class", NULL, ALWAYS_ACTS},
    {"tendon fixed spatial",
     "actuatorfrclimited actuatorfrcrange armature class damping frictionloss group limited material name range rgba "
     "springlength stiffness user width active polycoef tendon1 tendon2",
     NULL, ALWAYS_ACTS},
    {"joint tendon fixed spatial", "margin", smaller_range, ACTS_AT_STOPS},
    {"joint tendon fixed spatial", "solimplimit solreflimit solimpfriction solreffriction", rigid, ACTS_AT_STOPS},
    {"joint tendon fixed spatial", "springyield", "a <force> in a <system> that includes the robot", ALWAYS_ACTS},
    {"equality connect weld joint tendon", "solref solimp", rigid, ALWAYS_ACTS},
    {"equality connect weld", "active anchor body1 body2 class name relpose site1 site2 torquescale", NULL,
     ALWAYS_ACTS},
    {"general motor position velocity damper intvelocity cylinder",
     "armature class cranklength ctrllimited ctrlrange damping delay forcelimited forcerange gear group "
     "inheritrange interp joint jointinparent lengthrange name nsample refsite site tendon user",
     NULL, ALWAYS_ACTS},
    {"general", "actdim actearly actlimited actrange biasprm biastype dynprm dyntype gainprm gaintype", NULL,
     ALWAYS_ACTS},
    {"general adhesion", "body", NULL, ALWAYS_ACTS},
    {"adhesion", "class ctrllimited ctrlrange forcelimited forcerange gain group name user", NULL, ALWAYS_ACTS},
    {"position", "dampratio kp kv timeconst", NULL, ALWAYS_ACTS},
    {"velocity damper", "kv", NULL, ALWAYS_ACTS},
    {"intvelocity", "actlimited actrange dampratio kp kv", NULL, ALWAYS_ACTS},
    {"cylinder", "area bias diameter timeconst", NULL, ALWAYS_ACTS},
    {"general motor position velocity damper intvelocity cylinder", "cranksite slidersite ffrange input velrange",
     "an actuator at a joint, tendon or site, without it", ALWAYS_ACTS},
    {0},
};

void mjcf_check_attributes(struct Mjcf *mjcf) {
  static const char *const sections[] = {"compiler", "option",   "default", "worldbody",
                                         "actuator", "equality", "contact", "tendon"};
  for (xmlNodePtr section = mjcf->root->children; section != NULL; section = section->next)
    for (size_t i = 0; i < sizeof sections / sizeof *sections; i++)
      if (is_element(section, sections[i])) check_attributes(&mjcf->file, section, table);
}
