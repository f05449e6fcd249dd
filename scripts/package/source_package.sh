# For scripts that build from the distribution's source packages.

# source_package NAME=VERSION FOLDER: downloads the files of the source package into the existing FOLDER, without changing the user's apt.
source_package() {
  local folder=$2 list apt
  mkdir -p "$folder"/{lists/partial,cache,parts}
  # The distribution's package sources, changed to source packages.
  for list in /etc/apt/sources.list /etc/apt/sources.list.d/*; do
    if [ ! -f "$list" ] || ! grep -qE 'debian|ubuntu' "$list"; then continue; fi
    sed -e 's/^deb /deb-src /' -e 's/^Types:.*/Types: deb-src/' "$list" >"$folder/parts/${list##*/}"
  done
  apt=(apt-get -qq -o Dir::Etc::sourcelist=/dev/null -o "Dir::Etc::sourceparts=$folder/parts" -o "Dir::State::lists=$folder/lists"
    -o "Dir::Cache=$folder/cache" -o APT::Sandbox::User= -o Acquire::http::Timeout=20 -o Acquire::Retries=1)
  "${apt[@]}" update || true # some sources may lack source packages, and the others may suffice
  (cd "$folder" && "${apt[@]}" source --download-only "$1")
}
