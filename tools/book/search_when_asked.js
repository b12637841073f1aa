// The search index is larger than most pages, so it is fetched when somebody turns to the search, not with each page.
// The theme asks for it at once; its request is held back here until then, or until a found word is to be marked (?h=).
let wanted = new URL(location).searchParams.has("h")
const held = []
const open = XMLHttpRequest.prototype.open
const send = XMLHttpRequest.prototype.send
XMLHttpRequest.prototype.open = function (method, url, ...rest) {
  this.isIndex = String(url).endsWith("/search.json")
  return open.call(this, method, url, ...rest)
}
XMLHttpRequest.prototype.send = function (body) {
  if (this.isIndex && !wanted) held.push(this)
  else send.call(this, body)
}
const fetchIndex = () => {
  wanted = true
  for (const request of held.splice(0)) send.call(request)
}
for (const turned of ["pointerover", "focusin", "click"])
  addEventListener(turned, (event) => {
    if (event.target.closest?.(".md-search, [for=__search]")) fetchIndex()
  }, true)
addEventListener("keydown", (event) => {
  // The theme hears this key once the index is there.
  if (!wanted && event.key === "k" && (event.ctrlKey || event.metaKey)) {
    event.preventDefault()
    event.stopImmediatePropagation()
    document.querySelector(".md-search button").click()
  }
}, true)
