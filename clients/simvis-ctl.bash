# Completion of simvis-ctl for bash: names of served simulations, commands, elements and their parameters.
_simvis_ctl() {
  local word=${COMP_WORDS[COMP_CWORD]} names
  case $COMP_CWORD in
    1) names=$(ls /dev/shm 2>/dev/null | sed -n 's/^simvis-//p') ;;
    2) names="list get set watch send log frames" ;;
    *)
      case ${COMP_WORDS[2]} in
        get | watch) names=$(simvis-ctl "${COMP_WORDS[1]}" list 2>/dev/null | sed -n 's/^  \(.*\) = .*/\1/p') ;;
        set)
          names=$(simvis-ctl "${COMP_WORDS[1]}" list 2>/dev/null | sed -n 's/^  \(.*\) = .*/\1=/p')
          compopt -o nospace
          ;;
        send) compopt -o default ;;
      esac
      ;;
  esac
  local IFS=$'\n'
  COMPREPLY=($(compgen -W "$names" -- "$word"))
}
complete -F _simvis_ctl simvis-ctl
