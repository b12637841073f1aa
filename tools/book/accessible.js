// Tables and code that scroll can be reached by keyboard; each block of code names its bar.
const amend = () => {
  for (const box of document.querySelectorAll(".md-typeset__scrollwrap, .md-typeset__table, .md-typeset pre > code"))
    if (!box.hasAttribute("tabindex")) box.setAttribute("tabindex", "0")
  document.querySelectorAll("nav.md-code__nav").forEach((bar, i) => {
    const name = `Code block ${i + 1}`
    if (bar.getAttribute("aria-label") !== name) bar.setAttribute("aria-label", name)
  })
}
amend()
new MutationObserver(amend).observe(document.body, { childList: true, subtree: true })
