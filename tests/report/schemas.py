"""What a printed JSON Schema objects to, and a JUnit suite that keeps to its own."""

from __future__ import annotations

import contextlib
import io
import json
from pathlib import Path
from typing import Any

import pytest
from lxml import etree

from clearance.cli import run


def printed_schema(*options: str) -> tuple[dict[str, Any], Any]:
    """What `clearance schema` prints, and what asks whether something keeps to it."""
    jsonschema = pytest.importorskip("jsonschema")
    with contextlib.redirect_stdout(io.StringIO()) as out:
        assert run(["schema", *options]) == 0
    schema = json.loads(out.getvalue())
    jsonschema.Draft202012Validator.check_schema(schema)
    return schema, jsonschema.Draft202012Validator(schema)


def objections(results: str, told: dict[str, Any]) -> list[str]:
    """What the schema of a result file says of its content, as written."""
    schema, validator = printed_schema("--results", results)
    assert told["$schema"] == schema["$id"]
    lacking = [
        key
        for key in told
        if not [*validator.iter_errors({k: v for k, v in told.items() if k != key})]
    ]
    return [*lacking, *(error.message for error in validator.iter_errors(told))]


_SCHEMA = """
<xs:schema xmlns:xs="http://www.w3.org/2001/XMLSchema" elementFormDefault="qualified">
  <xs:simpleType name="named">
    <xs:restriction base="xs:string"><xs:minLength value="1"/></xs:restriction>
  </xs:simpleType>
  <xs:attributeGroup name="counted">
    <xs:attribute name="tests" type="xs:nonNegativeInteger" use="required"/>
    <xs:attribute name="failures" type="xs:nonNegativeInteger" use="required"/>
    <xs:attribute name="errors" type="xs:nonNegativeInteger" use="required"/>
    <xs:attribute name="skipped" type="xs:nonNegativeInteger"/>
    <xs:attribute name="time" type="xs:decimal"/>
  </xs:attributeGroup>
  <xs:complexType name="result"><xs:simpleContent><xs:extension base="xs:string">
    <xs:attribute name="message" type="named" use="required"/>
    <xs:attribute name="type" type="named"/>
  </xs:extension></xs:simpleContent></xs:complexType>
  <xs:element name="testsuites"><xs:complexType>
    <xs:sequence><xs:element ref="testsuite" maxOccurs="unbounded"/></xs:sequence>
    <xs:attributeGroup ref="counted"/>
  </xs:complexType></xs:element>
  <xs:element name="testsuite">
    <xs:complexType>
      <xs:sequence>
        <xs:element name="properties" minOccurs="0"><xs:complexType><xs:sequence>
          <xs:element name="property" maxOccurs="unbounded"><xs:complexType>
            <xs:attribute name="name" type="named" use="required"/>
            <xs:attribute name="value" type="xs:string" use="required"/>
          </xs:complexType></xs:element>
        </xs:sequence></xs:complexType></xs:element>
        <xs:element ref="testcase" minOccurs="0" maxOccurs="unbounded"/>
      </xs:sequence>
      <xs:attribute name="name" type="named" use="required"/>
      <xs:attributeGroup ref="counted"/>
    </xs:complexType>
    <xs:unique name="one_name_each">
      <xs:selector xpath="testcase"/><xs:field xpath="@classname"/><xs:field xpath="@name"/>
    </xs:unique>
  </xs:element>
  <xs:element name="testcase"><xs:complexType>
    <xs:sequence>
      <xs:choice minOccurs="0">
        <xs:element name="skipped" type="result"/>
        <xs:element name="failure" type="result"/>
        <xs:element name="error" type="result"/>
      </xs:choice>
      <xs:element name="system-out" type="xs:string" minOccurs="0"/>
      <xs:element name="system-err" type="xs:string" minOccurs="0"/>
    </xs:sequence>
    <xs:attribute name="name" type="named" use="required"/>
    <xs:attribute name="classname" type="named" use="required"/>
    <xs:attribute name="time" type="xs:decimal"/>
  </xs:complexType></xs:element>
</xs:schema>
"""


def valid_suite(path: Path) -> etree._Element:
    """The suite in a file that keeps to the schema, and whose counts are those of its cases."""
    document = etree.parse(path)
    etree.XMLSchema(etree.fromstring(_SCHEMA)).assertValid(document)
    (suite,) = document.getroot()
    for attribute, found in (
        ("tests", "testcase"),
        ("failures", "testcase/failure"),
        ("skipped", "testcase/skipped"),
        ("errors", "testcase/error"),
    ):
        assert int(suite.get(attribute)) == len(suite.findall(found))
        assert document.getroot().get(attribute) == suite.get(attribute)
    return suite
