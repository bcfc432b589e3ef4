// What works only with scripts is made by one, so that nothing idle is shown without.
(function () {
  "use strict";

  function key(cell) {
    return cell ? (cell.dataset.key || cell.textContent.trim()) : "";
  }

  function number(text) {
    return text === "inf" ? Infinity : text === "-inf" ? -Infinity : text === "" ? NaN : Number(text);
  }

  // What is not a number stays at the end in either direction.
  function sort(head) {
    var body = head.closest("table").tBodies[0], column = head.cellIndex;
    var up = head.getAttribute("aria-sort") !== "ascending", sign = up ? 1 : -1;
    head.parentNode.querySelectorAll("th").forEach(function (other) { other.removeAttribute("aria-sort"); });
    head.setAttribute("aria-sort", up ? "ascending" : "descending");
    var rows = Array.from(body.rows).map(function (row) {
      var text = key(row.cells[column]);
      return { row: row, text: text, number: number(text) };
    });
    rows.sort(function (a, b) {
      if (isNaN(a.number) && isNaN(b.number)) return sign * a.text.localeCompare(b.text);
      if (isNaN(a.number) || isNaN(b.number)) return isNaN(a.number) ? 1 : -1;
      return sign * (a.number < b.number ? -1 : a.number > b.number ? 1 : 0);
    });
    rows.forEach(function (entry) { body.appendChild(entry.row); });
  }

  // A text that a spreadsheet would take for a formula gets an apostrophe, a number does not.
  function quoted(text) {
    if (isNaN(number(text)) && /^\s*[=+\-@]/.test(text)) text = "'" + text;
    return /[",\r\n]/.test(text) ? '"' + text.replace(/"/g, '""') + '"' : text;
  }

  // RFC 4180. A cell may stand for two columns: a name and its id.
  function csv(table) {
    function line(row, name) {
      return Array.from(row.cells).map(function (cell) {
        var text = quoted(name ? cell.textContent.trim().replace(/\s+/g, " ") : cell.dataset.name || key(cell));
        return cell.dataset.id === undefined ? text : quoted(cell.dataset.id) + "," + text;
      }).join(",");
    }
    var head = Array.from(table.tHead.rows).map(function (row) { return line(row, true); });
    var body = Array.from(table.tBodies[0].rows).map(function (row) { return line(row, false); });
    return head.concat(body).join("\r\n") + "\r\n";
  }

  function download(table) {
    var link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([csv(table)], { type: "text/csv;charset=utf-8" }));
    link.download = table.dataset.file + ".csv";
    document.body.appendChild(link);
    link.click();
    link.remove();
    setTimeout(function () { URL.revokeObjectURL(link.href); }, 1000);
  }

  document.querySelectorAll("table[data-file]").forEach(function (table) {
    table.querySelectorAll("thead th").forEach(function (head) {
      var button = document.createElement("button");
      button.type = "button";
      while (head.firstChild) button.appendChild(head.firstChild);
      head.appendChild(button);
      button.addEventListener("click", function () { sort(head); });
    });
    var tools = document.createElement("div"), button = document.createElement("button");
    tools.className = "tools";
    button.type = "button";
    button.textContent = "Download CSV";
    button.setAttribute("aria-label", "Download CSV: " + table.caption.textContent.trim());
    button.addEventListener("click", function () { download(table); });
    tools.appendChild(button);
    table.parentNode.parentNode.insertBefore(tools, table.parentNode);
  });
})();
