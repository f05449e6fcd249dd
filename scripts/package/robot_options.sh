# For scripts that take the file of a robot.
# robot_options_help: the options, for --help.
# take_robot_options WORDS...: sets the array robot to the options for the file of a robot among the words, as WORD=VALUE of lagc, and the array
# others to the remaining words.
robot_options_help="For the file of a robot: --base floating, --ground or --feet LINK,..., --self, --limits stops, --friction sticks, --effort limited,
--keyframe NAME, --mocap inputs, --tool LINK, as in an <include>."

take_robot_options() {
  robot=() others=()
  while [ $# -gt 0 ]; do
    case $1 in
    --base=* | --limits=* | --friction=* | --effort=* | --keyframe=* | --mocap=* | --tool=*) robot+=("${1#--}") ;;
    --feet=*) robot+=("ground=$(tr , ' ' <<<"${1#--feet=}")") ;;
    --ground | --self) robot+=("${1#--}=true") ;;
    --base | --limits | --friction | --effort | --keyframe | --mocap | --tool | --feet)
      if [ $# = 1 ]; then
        echo "$command: $1 needs a value; see $command --help" >&2
        exit 2
      fi
      set -- "$1=$2" "${@:3}"
      continue
      ;;
    *) others+=("$1") ;;
    esac
    shift
  done
}
