# Builds the FMU of a system; sourced by scripts that take a system as an argument.
# Input: $command, the name of the script; $here, the folder in which it was called; $needed, the argument for scripts/setup; and $system, a name
# in fmu/, or the path of a folder with a system.xml, of such a file, or of that of a robot; the array $robot may have options for it.
# Output: $fmu, the FMU; $name, its name; $file, the system's file; $build, the build folder.
if [ -f "fmu/$system/system.xml" ]; then
  source=$PWD/fmu/$system
else
  source=$(cd "$here" && realpath -m -- "$system")
  if [ "${source##*/}" = system.xml ]; then source=${source%/*}; fi
  inside=("$source"/*/system.xml)
  if [ ! -f "$source/system.xml" ] && [ ${#inside[@]} = 1 ] && [ -f "${inside[0]}" ]; then source=${inside[0]%/*}; fi
fi
file=$source
if [ ! -f "$file" ]; then file=$source/system.xml; fi
if [ ! -f "$file" ]; then
  if [ -f "${inside[0]}" ]; then
    echo "$command: $source holds several systems; name one of them: ${inside[*]%/system.xml}" >&2
  else
    echo "$command: there is neither fmu/$system/system.xml nor $source/system.xml; the systems in fmu are:" \
      "$(cd fmu && dirname */system.xml | xargs)" >&2
  fi
  exit 1
fi

if [ -n "${robot[*]-}" ] && [ ! -f "$source" ]; then
  echo "$command: $system is no file of a robot; expected one for ${robot[*]}" >&2
  exit 1
fi
build=build
if [ "${source%/*}" != "$PWD/fmu" ]; then build=build/own; fi
scripts/setup $needed
if grep -qE "method *= *[\"'](bdf|erk)[\"']" "$file"; then scripts/package/sundials; fi
name=${source##*/}
if [ $build = build ]; then scripts/build build; else scripts/build $build -DSYSTEMS="$source" -DROBOT="$(IFS=";" && echo "${robot[*]-}")"; fi
if [ -f "$source" ]; then name=$(cat $build/system_names); fi
fmu=$build/fmu/$name.fmu
