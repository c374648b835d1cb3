# Completion of simvis-ctl for bash: names of served simulations, commands, elements and their parameters.
_simvis_ctl() {
  local word=${COMP_WORDS[COMP_CWORD]} name
  COMPREPLY=()
  # Names are text of other processes: they are compared and quoted, never expanded as `compgen -W` does.
  while IFS= read -r name; do
    [[ $name == "$word"* ]] && COMPREPLY+=("$(printf %q "$name")")
  done < <(
    case $COMP_CWORD in
      1) sed -n 's/^.* @simvis-\([A-Za-z0-9._-]*\)$/\1/p' /proc/net/unix 2>/dev/null | sort -u ;;
      2) printf '%s\n' list get set watch send log frames ;;
      *)
        case ${COMP_WORDS[2]} in
          get | watch) simvis-ctl "${COMP_WORDS[1]}" list 2>/dev/null | sed -n 's/^  \(.*\) = .*/\1/p' ;;
          set) simvis-ctl "${COMP_WORDS[1]}" list 2>/dev/null | sed -n 's/^  \(.*\) = .*/\1=/p' ;;
        esac
        ;;
    esac
  )
  case ${COMP_WORDS[2]} in
    set) [[ $COMP_CWORD -gt 2 ]] && compopt -o nospace ;;
    send) [[ $COMP_CWORD -gt 2 ]] && compopt -o default ;;
  esac
}
complete -F _simvis_ctl simvis-ctl
